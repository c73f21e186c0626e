#include "firmware-host/runtime/side_check.h"

#include <vector>

#include "core/frontend/front_end.h"

namespace pelorus {
namespace {

constexpr int kPoints = 400;
// Far things match both ways: a few pixels are within the reach of the search around zero.
constexpr float kClearDisparity_px = 3.0F;
constexpr int kEnoughMatches = 40;
constexpr int kMajority = 5;  // times as many
constexpr int kPairsAsked = 2;
constexpr int kPairsRead = 5;

int count_matches(const ImageView& left, const ImageView& right) {
  const FrontEndConfig config;
  Surf surf(SurfConfig{.max_points = kPoints}, left.width, left.height);
  std::vector<StereoTask> tasks;
  for (const SurfPoint& point : surf.detect(left)) {
    StereoTask task;
    task.u_left_px = point.u_px;
    task.v_px = point.v_px;
    tasks.push_back(task);
  }
  ImagePyramid left_pyramid;
  ImagePyramid right_pyramid;
  left_pyramid.build(left, config.klt.levels);
  right_pyramid.build(right, config.klt.levels);
  StereoMatcher(config.stereo, Klt(config.klt)).match(left_pyramid, right_pyramid, tasks);
  int count = 0;
  for (const StereoTask& task : tasks) {
    if (task.outcome == StereoOutcome::ok && task.u_left_px - task.u_right_px > kClearDisparity_px) ++count;
  }
  return count;
}

// Each picture goes through the lens of the side it is taken for: exchanged pictures match only when rectified so.
int count_matches(const Image& left, const Image& right, const Rectifier& rectifier) {
  if (rectifier.is_pass_through()) return count_matches(left.view(), right.view());
  Image rectified_left;
  Image rectified_right;
  rectifier.apply_left(left.view(), rectified_left);
  rectifier.apply_right(right.view(), rectified_right);
  return count_matches(rectified_left.view(), rectified_right.view());
}

}  // namespace

SideMatches match_sides(const SourcePair& pair, const Rectifier& rectifier) {
  return {count_matches(pair.left, pair.right, rectifier), count_matches(pair.right, pair.left, rectifier)};
}

Sides sides_of(const SideMatches& matches) {
  if (matches.as_given >= kEnoughMatches && matches.as_given > kMajority * matches.exchanged) return Sides::as_given;
  if (matches.exchanged >= kEnoughMatches && matches.exchanged > kMajority * matches.as_given) return Sides::exchanged;
  return Sides::unclear;
}

Result<> check_sides(StereoSource& source, const std::string& place) {
  const Result<Rectifier> rectifier = Rectifier::create(source.calibration(), place);
  if (!rectifier) return rectifier.error();
  SourcePair pair;
  int exchanged = 0;
  for (int read = 0; read < kPairsRead; ++read) {
    const Result<bool> more = source.next(pair);
    if (more.ok() && !more.value()) break;
    if (!more.ok()) continue;
    const Sides sides = sides_of(match_sides(pair, rectifier.value()));
    if (sides == Sides::as_given) return Ok{};
    if (sides == Sides::exchanged && ++exchanged == kPairsAsked) break;
  }
  if (exchanged == 0) return Ok{};
  return Error{ErrorCode::bad_input, place,
               "the left and right pictures are exchanged: points match only when they change places",
               "exchange the two folders of pictures (EuRoC cam0 and cam1, KITTI image_0 and image_1), or record LEFT "
               "and RIGHT the other way round"};
}

}  // namespace pelorus
