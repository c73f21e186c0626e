// FrontEnd's pieces of work for other threads. Part of FrontEnd (front_end.h). Tasks are independent, so that results
// do not depend on who does which.

#include "core/frontend/front_end.h"

namespace pelorus {
namespace {

constexpr std::size_t kWorthSharing = 40;  // fewer tasks take less than the wake-up of another thread

}  // namespace

void FrontEnd::track(std::span<KltTask> tasks, const ImagePyramid& from, const ImagePyramid& to, KltSearch search,
                     int coarsest_level, bool predicted) {
  const bool shared = tasks.size() >= kWorthSharing;
  const std::size_t half = shared ? tasks.size() / 2 : 0;
  if (shared) {
    share_ = {&from, &to, tasks.first(half), search, coarsest_level, predicted, {}};
    workers_.tracking.start(work_of<&FrontEnd::track_share>(*this));
  }
  klt_.track(from, to, tasks.subspan(half), search, coarsest_level, predicted);
  if (shared) workers_.tracking.wait();
}

void FrontEnd::track_share() {
  klt_.track(*share_.from, *share_.to, share_.tasks, share_.search, share_.coarsest_level, share_.predicted);
}

void FrontEnd::match_share() { stereo_.match(images_.current(), images_.right, share_.stereo_tasks); }

// Starts detection on the current left image, once.
void FrontEnd::detect() {
  if (!detected_) workers_.surf.start(work_of<&FrontEnd::detect_now>(*this));
  detected_ = true;
}

void FrontEnd::detect_now() { detected_points_ = surf_.detect(frame_.left); }

void FrontEnd::describe_starts() { surf_.describe(starts_, descriptors_); }

}  // namespace pelorus
