#include "firmware-host/pelorus/export/mcap_export.h"

#include "firmware-host/pelorus/export/foxglove_json.h"
#include "firmware-host/pelorus/export/mcap_writer.h"

namespace pelorus {

Result<> export_mcap(const EstimatedRun& run, const std::filesystem::path& path, bool overwrite) {
  Result<McapWriter> made = McapWriter::create(path, overwrite);
  if (!made) return made.error();
  McapWriter& mcap = made.value();
  const auto add = [&](const char* topic, const std::string& schema) {
    return mcap.add_channel(topic, schema, foxglove::schema_of(schema));
  };
  const std::uint16_t poses = add("/camera/pose", "foxglove.PoseInFrame");
  const std::uint16_t transforms = add("/tf", "foxglove.FrameTransform");
  const std::uint16_t bodies = add("/bodies", "foxglove.SceneUpdate");
  const std::uint16_t frames = add("/frame", "pelorus.Frame");
  for (const EstimatedFrame& frame : run) {
    const Timestamp time = frame.capture_time;
    const auto at_ns = static_cast<std::uint64_t>(time.ns);
    mcap.write(frames, at_ns, foxglove::frame_facts(frame));
    if (frame.T_world_cam) {
      mcap.write(poses, at_ns, foxglove::pose_in_frame(time, "world", *frame.T_world_cam));
      mcap.write(transforms, at_ns, foxglove::frame_transform(time, "world", "camera", *frame.T_world_cam));
    }
    for (const EstimatedObject& object : frame.objects) {
      mcap.write(transforms, at_ns,
                 foxglove::frame_transform(time, "world", foxglove::body_frame(object.id), object.T_world_obj));
    }
    mcap.write(bodies, at_ns, foxglove::scene_update(frame));
  }
  return mcap.finish();
}

}  // namespace pelorus
