#pragma once
// SceneWriter: the reconstructed scene of a run, for `pelorus report` and for export.
// points.csv    one row per point followed over at least kFewestViews frames: points of the static scene in `world`,
//               points of a body in that body's own frame `obj`, so that all views of a body come together.
// outlines.csv  the outline of each body in each frame, in its own frame: the image outline at the centroid's depth.
// A row is written when its point is no longer followed: memory is bounded by the points of one step, the files grow
// with the run as the others do. Same input, same bytes. Thread-bound. One per output folder.

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>

#include "core/base/result.h"
#include "core/model/stage_data.h"
#include "firmware-host/pelorus/results/result_files.h"

namespace pelorus {

// Fewer views of a point may be one mismatch.
inline constexpr int kFewestViews = 3;

class SceneWriter {
 public:
  // The folder must exist (prepare_output_folder).
  [[nodiscard]] static Result<SceneWriter> create(const std::filesystem::path& folder, const StereoRig& rig);
  // Every step in order, with the left image that the step saw and the points it left (Pipeline::points).
  [[nodiscard]] Result<Ok> append(const FrameResult& result, std::span<const PointView> points, const ImageView& left);
  // Writes the points that are still followed. Call once, at the end of the run, however it ended.
  [[nodiscard]] Result<Ok> finish();

 private:
  // Views of one point so far: weighted sums of its position in the frame of its body.
  struct Followed {
    BodyId body;
    double weight = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double sum_of_squares = 0;  // of the distance from the first view
    Eigen::Vector3d first_view = Eigen::Vector3d::Zero();
    int views = 0;
    std::int64_t gray_sum = 0;
    Timestamp first_seen;
    Timestamp last_seen;
    std::uint64_t last_step = 0;
  };
  SceneWriter() = default;
  void observe(const FrameResult& result, const PointView& point, const ImageView& left);
  void write_point(TrackId track, const Followed& followed);
  void write_outline(const FrameResult& result, const ObjectState& object);

  StereoRig rig_;
  ResultFile points_;
  ResultFile outlines_;
  std::map<TrackId, Followed> followed_;  // ordered: rows must not depend on a hash
  std::uint64_t step_ = 0;
};

}  // namespace pelorus
