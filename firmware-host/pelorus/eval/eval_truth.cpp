#include "firmware-host/pelorus/eval/eval_truth.h"

#include <filesystem>

#include "core/geometry/rectifier.h"
#include "drivers/replay/euroc.h"
#include "drivers/replay/kitti.h"
#include "firmware-host/pelorus/eval/eval_truth_layouts.h"
#include "firmware-host/runtime/replay_source.h"

namespace pelorus {
namespace {

// Steps below these cannot be seen in any image of ours: the body rests.
constexpr double kRestingStep_m = 5e-4;
constexpr double kRestingStep_rad = 5e-4;

}  // namespace

void mark_moving_bodies(Truth& truth) {
  const auto T_truth_body = [&](std::size_t frame, int body) -> std::optional<Rigid3> {
    const TrueBodyView* view = truth.frames[frame].find(body);
    if (!view || !truth.frames[frame].T_truth_cam) return std::nullopt;
    return *truth.frames[frame].T_truth_cam * view->T_cam_body;
  };
  for (std::size_t i = 0; i < truth.frames.size(); ++i) {
    for (TrueBodyView& view : truth.frames[i].bodies) {
      // The first frame has no step behind it: the one ahead speaks for it.
      const std::size_t from = i == 0 ? 0 : i - 1;
      const std::size_t to = std::min(from + 1, truth.frames.size() - 1);
      const auto before = T_truth_body(from, view.body);
      const auto after = T_truth_body(to, view.body);
      if (!before || !after) continue;
      view.moving = (after->translation() - before->translation()).norm() > kRestingStep_m ||
                    rotation_angle_rad(before->linear().transpose() * after->linear()) > kRestingStep_rad;
    }
  }
}

Result<std::optional<Truth>> read_truth(const std::string& dataset, const std::string& calibration_file,
                                        const EstimatedRun& run) {
  std::error_code ignored;
  const std::filesystem::path folder(dataset);
  if (std::filesystem::is_directory(folder, ignored)) {
    if (is_kitti_raw(folder)) return read_kitti_raw_truth(folder, run);
    if (is_kitti_odometry(folder)) return read_kitti_odometry_truth(folder, run);
  }
  Result<std::unique_ptr<StereoSource>> source = open_source(dataset, calibration_file);
  if (!source) return source.error();
  if (auto* scene = dynamic_cast<synthetic::SyntheticSource*>(source.value().get())) {
    return std::optional<Truth>(scene_truth(*scene, run));
  }
  const std::filesystem::path mav0 = find_euroc(folder);
  if (mav0.empty()) return std::optional<Truth>();
  Result<Rectifier> rectifier = Rectifier::create(source.value()->calibration(), dataset);
  if (!rectifier) return rectifier.error();
  return read_euroc_truth(mav0, rectifier.value().T_body_cam(), run);
}

}  // namespace pelorus
