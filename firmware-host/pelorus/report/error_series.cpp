#include "firmware-host/pelorus/report/error_series.h"

#include <limits>
#include <map>

#include "core/base/check.h"
#include "core/evaluation/motion_error.h"
#include "core/evaluation/trajectory_error.h"

namespace pelorus {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Error of the estimated motion from pose a to pose b, seen in the true camera at b.
Rigid3 relative_error(const PosePair& a, const PosePair& b) {
  return (a.T_truth_cam.inverse() * b.T_truth_cam).inverse() * (a.T_world_cam.inverse() * b.T_world_cam);
}

std::vector<ErrorSample> camera_series(const std::vector<PosePair>& poses) {
  std::vector<ErrorSample> samples;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Rigid3 since_start = relative_error(poses.front(), poses[i]);
    ErrorSample sample{poses[i].frame,
                       kWorldBody,
                       kNone,
                       kNone,
                       since_start.translation().norm(),
                       rotation_angle_rad(since_start.linear())};
    if (poses[i].frame == poses[i - 1].frame + 1) {
      const Rigid3 step = relative_error(poses[i - 1], poses[i]);
      sample.step_m = step.translation().norm();
      sample.step_rad = rotation_angle_rad(step.linear());
    }
    samples.push_back(sample);
  }
  return samples;
}

// Where an estimated object and the true body stood in the first frame that has both.
struct Birth {
  Rigid3 T_world_obj;
  Rigid3 T_world_body;
};

class BodySeries {
 public:
  BodySeries(const EstimatedRun& run, const Truth& truth, const Rigid3& T_truth_world, int body)
      : run_(run), truth_(truth), T_truth_world_(T_truth_world), body_(body) {
    for (std::size_t i = 0; i < run.size(); ++i) {
      const std::optional<Rigid3> T_world_body = true_pose(i);
      if (!T_world_body) continue;
      for (const EstimatedObject& object : run[i].objects) {
        births_.try_emplace(object.id, Birth{object.T_world_obj, *T_world_body});
      }
    }
  }

  // Appends the frame's sample, if a confirmed object was the body.
  void observe(std::size_t frame, const FrameMatches& matches, std::vector<ErrorSample>& samples) const {
    const ObjectMatch* match = matches.of_body(body_);
    const std::optional<Rigid3> T_world_curr = true_pose(frame);
    if (!match || !T_world_curr) return;
    for (const EstimatedObject& object : run_[frame].objects) {
      if (object.id != match->object || object.phase != ObjectPhase::confirmed) continue;
      ErrorSample sample{frame, object.id, kNone, kNone, 0, 0};
      if (const std::optional<Rigid3> T_world_prev = true_pose(frame - 1)) {
        const Rigid3 error =
            error_in_body_frame(*T_world_curr * T_world_prev->inverse(), object.M_world, *T_world_prev);
        sample.step_m = error.translation().norm();
        sample.step_rad = rotation_angle_rad(error.linear());
      }
      const Birth& birth = births_.at(object.id);
      const Rigid3 error = error_in_body_frame(*T_world_curr * birth.T_world_body.inverse(),
                                               object.T_world_obj * birth.T_world_obj.inverse(), birth.T_world_body);
      sample.absolute_m = error.translation().norm();
      sample.absolute_rad = rotation_angle_rad(error.linear());
      samples.push_back(sample);
    }
  }

 private:
  std::optional<Rigid3> true_pose(std::size_t frame) const {
    return true_body_in_world(truth_.frames[frame], body_, T_truth_world_);
  }

  const EstimatedRun& run_;
  const Truth& truth_;
  Rigid3 T_truth_world_;
  int body_;
  std::map<BodyId, Birth> births_;
};

}  // namespace

ErrorSeries error_series(const EstimatedRun& run, const Truth& truth, const AssociationConfig& config) {
  PELORUS_CHECK(truth.frames.size() == run.size(), "truth must have one entry per frame of the run");
  ErrorSeries series;
  const std::vector<PosePair> poses = common_poses(run, truth);
  series.camera = camera_series(poses);
  const std::optional<Rigid3> T_truth_world = first_pose_alignment(poses);
  if (!T_truth_world || !truth.knows_bodies) return series;
  const std::vector<FrameMatches> matches = associate(run, truth, config);
  for (std::size_t i = 0; i < truth.bodies.size(); ++i) {
    BodyErrors errors{static_cast<int>(i), {}};
    const BodySeries body(run, truth, *T_truth_world, errors.body);
    for (std::size_t frame = 1; frame < matches.size(); ++frame) body.observe(frame, matches[frame], errors.samples);
    if (!errors.samples.empty()) series.bodies.push_back(std::move(errors));
  }
  return series;
}

}  // namespace pelorus
