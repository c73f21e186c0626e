#pragma once
// A point followed over frames: identity, measurements, the reference image it is anchored to. Pure data.

#include "core/frontend/surf.h"
#include "core/model/stage_data.h"

namespace pelorus {

struct Track {
  TrackId id;
  StereoPoint latest;
  std::array<Eigen::Vector3d, kPastFrames + 1> past_px{};  // [0] = one frame before latest
  int past_size = 0;
  int age = 0;  // frames since birth; 0 = started on the latest frame
  BodyId body = kNoBody;
  int unexplained = 0;                                           // frames in a row that fit no body's motion
  Eigen::Vector2d disparity_gradient = Eigen::Vector2d::Zero();  // of the surface around it, px/px; 0 = unknown
  double match_error = 0;                                        // 1 - NCC of the latest match
  double sigma_px = 0.25;
  // Anchor: the patch in a kept earlier left image against which the place is refined, so that errors do not add
  // up from frame to frame. warp maps offsets there to offsets in the latest left image.
  int reference = -1;  // slot of the kept image, -1 = none yet
  float u_reference_px = 0;
  float v_reference_px = 0;
  std::array<float, 4> warp{1, 0, 0, 1};
  SurfDescriptor descriptor{};  // of its birth; stays with the point for re-identification
  std::int8_t laplacian = 0;
  bool has_descriptor = false;
};

}  // namespace pelorus
