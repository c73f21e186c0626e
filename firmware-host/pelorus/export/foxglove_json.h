#pragma once
// Messages in the JSON form of Foxglove's well-known schemas (docs.foxglove.dev/docs/visualization/message-schemas),
// and JSON Schemas that describe what we write of them, so that Foxglove and PlotJuggler know the fields. Quaternions
// here have named parts. Pure.

#include <string>
#include <vector>

#include "core/evaluation/records.h"

namespace pelorus::foxglove {

// {"name": schema} pairs by name: foxglove.PoseInFrame, foxglove.FrameTransform, foxglove.SceneUpdate, pelorus.Frame.
[[nodiscard]] std::string schema_of(const std::string& name);

[[nodiscard]] std::string pose_in_frame(Timestamp time, const std::string& frame, const Rigid3& T_frame_x);
// T_parent_child.
[[nodiscard]] std::string frame_transform(Timestamp time, const std::string& parent, const std::string& child,
                                          const Rigid3& T_parent_child);
// Every body of the frame as a box with its number; the viewer forgets what is not in the next update.
[[nodiscard]] std::string scene_update(const EstimatedFrame& frame);
// What the system thought of the frame, as numbers to plot.
[[nodiscard]] std::string frame_facts(const EstimatedFrame& frame);

[[nodiscard]] std::string body_frame(BodyId body);  // "body_3"

}  // namespace pelorus::foxglove
