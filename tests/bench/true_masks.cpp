// What the true masks are worth without any method: every point is given to the body that the renderer says it shows,
// and each body's motion is that of two frames, by our own tracker and our own estimator (or the paper's alignment of
// clouds). The yardstick for `pelorus eval`, which has no masks. Prints a row per body: median error of the step and
// mean error since birth, at the body's center, in its own frame.
// usage: true_masks SCENE.yaml [FRAMES]

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/evaluation/error_statistics.h"
#include "core/evaluation/motion_error.h"
#include "core/frontend/front_end.h"
#include "core/motion/two_frame_ba.h"
#include "drivers/synthetic/ray_batch.h"
#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"

namespace pelorus {
namespace {

using synthetic::SyntheticSource;

constexpr int kFewest = 6;          // points of a body below which there is no motion
constexpr double kSigma_px = 0.05;  // of points in clear water: sets what counts as an outlier

// By the index of the scene's bodies: which of the moving ones it is, counted from 1; the world for the others.
std::vector<BodyId> owners(const SyntheticSource& source) {
  std::vector<BodyId> owner(source.scene().bodies.size(), kWorldBody);
  for (int object = 0; object < source.object_count(); ++object) {
    owner[static_cast<std::size_t>(&source.object_body(object) - source.scene().bodies.data())] = BodyId{object + 1};
  }
  return owner;
}

BodyId owner_at(const SyntheticSource& source, const std::vector<BodyId>& owner, const Eigen::Vector3d& z_px) {
  const synthetic::Film& film = source.left_film();
  const int key = film.keys[film.at(static_cast<int>(z_px.x() + 0.5), static_cast<int>(z_px.y() + 0.5))];
  const int solid = synthetic::solid_of_key(key);
  return solid < 0 || solid >= static_cast<int>(owner.size()) ? kWorldBody : owner[static_cast<std::size_t>(solid)];
}

struct Errors {
  std::vector<double> step_m, step_rad, since_birth_m, since_birth_rad, points;
  Rigid3 M_world_birth = Rigid3::Identity();
  int birth = -1;
};

// Over one dive, with one estimator.
class FrameToFrame {
 public:
  FrameToFrame(SyntheticSource& source, const StereoRig& rig, bool adjust)
      : source_(source),
        rig_(rig),
        owner_(owners(source)),
        front_end_(config_, rig, {inline_, inline_}),
        two_frame_ba_({.adjust = adjust}, config_.max_points),
        errors_(static_cast<std::size_t>(source.object_count()) + 1) {
    motions_.push_back({kWorldBody, Rigid3::Identity()});
  }

  void step(int frame, const SourcePair& pair) {
    const PointPairs pairs = front_end_.run(
        {static_cast<std::uint64_t>(frame), source_.capture_time(frame), pair.left.view(), pair.right.view()},
        motions_);
    std::vector<BodyId> body_of_pair;
    for (const PointPair& p : pairs) body_of_pair.push_back(owner_at(source_, owner_, p.curr.z_px));
    front_end_.set_sigma(kSigma_px);
    motions_.clear();
    for (int body = 0; body <= source_.object_count(); ++body) measure(BodyId{body}, frame, pairs, body_of_pair);
    front_end_.settle(body_of_pair, motions_);
    front_end_.refill({}, false);
  }

  void print(const char* estimator) const {
    for (std::size_t body = 0; body < errors_.size(); ++body) {
      const Errors& e = errors_[body];
      const std::string name = body == 0 ? "camera" : source_.object_body(static_cast<int>(body) - 1).name;
      const ErrorStatistics step_m = summarize(e.step_m), step_rad = summarize(e.step_rad);
      const ErrorStatistics birth_m = summarize(e.since_birth_m), birth_rad = summarize(e.since_birth_rad);
      std::printf("%-10s %-10s %6.1f %9.4f %9.4f %9.4f %9.3f %9.3f\n", estimator, name.c_str(),
                  summarize(e.points).mean, 100 * step_m.mean, 100 * step_m.median, step_rad.median * 180 / M_PI,
                  100 * birth_m.mean, birth_rad.mean * 180 / M_PI);
    }
  }

 private:
  void measure(BodyId body, int frame, PointPairs pairs, const std::vector<BodyId>& body_of_pair) {
    std::vector<PointIndex> members;
    std::vector<PointMatch> matches;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (body_of_pair[i] != body) continue;
      members.push_back(static_cast<PointIndex>(i));
      matches.push_back({pairs[i].prev.p_cam, pairs[i].curr.p_cam, 1.0});
    }
    const auto start = static_cast<int>(members.size()) < kFewest ? std::nullopt : fit_rigid(matches);
    if (!start) {
      if (body == kWorldBody) motions_.push_back({kWorldBody, Rigid3::Identity()});
      return;
    }
    errors_[static_cast<std::size_t>(body.value)].points.push_back(static_cast<double>(members.size()));
    const MotionFit fit = two_frame_ba_.run(rig_, pairs, members, *start);
    motions_.push_back({body, fit.H_curr_prev});
    if (body == kWorldBody) {
      T_world_cam_prev_ = T_world_cam_;
      T_world_cam_ = T_world_cam_ * fit.H_curr_prev.inverse();
      note(body, frame, T_world_cam_prev_.inverse() * T_world_cam_, Rigid3::Identity(),
           source_.T_world_cam(frame - 1).inverse() * source_.T_world_cam(frame));
    } else {
      const int object = body.value - 1;
      const Rigid3 T_world_prev = source_.T_world_obj(object, frame - 1);
      note(body, frame, T_world_cam_ * fit.H_curr_prev * T_world_cam_prev_.inverse(), T_world_prev,
           source_.T_world_obj(object, frame) * T_world_prev.inverse());
    }
  }

  void note(BodyId body, int frame, const Rigid3& M, const Rigid3& T_world_body, const Rigid3& M_true) {
    Errors& e = errors_[static_cast<std::size_t>(body.value)];
    const Rigid3 step = error_in_body_frame(M_true, M, T_world_body);
    e.step_m.push_back(step.translation().norm());
    e.step_rad.push_back(rotation_angle_rad(step.linear()));
    if (body == kWorldBody) return;
    if (e.birth < 0) e.birth = frame - 1;
    e.M_world_birth = M * e.M_world_birth;
    const int object = body.value - 1;
    const Rigid3 T_world_birth = source_.T_world_obj(object, e.birth);
    const Rigid3 since = error_in_body_frame(source_.T_world_obj(object, frame) * T_world_birth.inverse(),
                                             e.M_world_birth, T_world_birth);
    e.since_birth_m.push_back(since.translation().norm());
    e.since_birth_rad.push_back(rotation_angle_rad(since.linear()));
  }

  SyntheticSource& source_;
  StereoRig rig_;
  std::vector<BodyId> owner_;
  FrontEndConfig config_;
  InlineWorker inline_;
  FrontEnd front_end_;
  TwoFrameBa two_frame_ba_;
  std::vector<BodyPrediction> motions_;
  std::vector<Errors> errors_;
  Rigid3 T_world_cam_ = Rigid3::Identity();
  Rigid3 T_world_cam_prev_ = Rigid3::Identity();
};

int compare(const std::string& file, int frames) {
  Result<synthetic::Scene> scene = synthetic::load_scene(file);
  if (!scene) {
    std::fprintf(stderr, "true_masks: %s\n", scene.error().message().c_str());
    return 3;
  }
  if (frames > 0) scene.value().frames = frames;
  SyntheticSource source(scene.value());
  const CameraIntrinsics& camera = source.calibration().left;
  const StereoRig rig{camera.width, camera.height, camera.fx_px,
                      camera.cx_px, camera.cy_px,  -source.calibration().T_right_left.translation().x()};
  FrameToFrame adjusted(source, rig, true);
  FrameToFrame aligned(source, rig, false);
  SourcePair pair;
  for (int frame = 0; source.next(pair).value(); ++frame) {
    adjusted.step(frame, pair);
    aligned.step(frame, pair);
  }
  std::printf("estimator  body      points  mean, cm  med., cm med., deg birth, cm birth,deg\n");
  adjusted.print("two frames");
  aligned.print("clouds (1)");
  return 0;
}

}  // namespace
}  // namespace pelorus

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: true_masks SCENE.yaml [FRAMES]\n");
    return 2;
  }
  return pelorus::compare(argv[1], argc > 2 ? std::atoi(argv[2]) : 0);
}
