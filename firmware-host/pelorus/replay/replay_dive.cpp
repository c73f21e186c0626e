#include "firmware-host/pelorus/replay/replay_dive.h"

#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "firmware-host/pelorus/progress_bar.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"
#include "firmware-host/pelorus/synth/asl_writer.h"
#include "firmware-host/runtime/scene_lookup.h"

namespace pelorus {

Result<bool> render_dive(const std::string& scene_name, std::uint64_t max_frames, const std::filesystem::path& folder) {
  const Result<std::string> path = find_scene(scene_name);
  if (!path) return path.error();
  Result<synthetic::Scene> scene = synthetic::load_scene(path.value());
  if (!scene) return scene.error();
  if (max_frames > 0) scene.value().frames = std::min(scene.value().frames, static_cast<int>(max_frames));
  synthetic::SyntheticSource source(scene.value());
  Result<AslWriter> writer = AslWriter::open(folder, true, source);
  if (!writer) return writer.error();
  ProgressBar bar("rendering", source.pair_count(), "pairs");
  SourcePair pair;
  for (int frame = 0; frame < source.scene().frames; ++frame) {
    if (ReplayInterrupt::requested()) return false;
    source.render(frame, pair);
    if (Result<> written = writer.value().append(frame, pair, source); !written) return written.error();
    bar.update(static_cast<std::size_t>(frame) + 1);
  }
  if (Result<> finished = writer.value().finish(); !finished) return finished.error();
  return true;
}

}  // namespace pelorus
