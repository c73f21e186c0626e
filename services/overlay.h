#pragma once
// Overlay: a picture of what the system believes about one frame: points coloured by body (the static scene a quiet
// grey-green, each object its own saturated colour, unexplained points white), object outlines with id, range and
// speed, the trail of each object, a state banner. Only confirmed and coasting objects are labelled. Remembers the
// last centroids for the trails: feed it every frame in order, draw the ones wanted. Thread-bound.

#include <deque>
#include <map>
#include <opencv2/core.hpp>
#include <span>

#include "core/model/stage_data.h"

namespace pelorus {

class Overlay {
 public:
  explicit Overlay(const StereoRig& rig) : rig_(rig) {}

  // Advances the trails and speeds; every frame, or with the time that the steps of the result span (`step`) when only
  // some are observed.
  void observe(const FrameResult& result, Duration step = {});
  // The picture of the frame observed last: BGR, the banner above the left image.
  [[nodiscard]] cv::Mat draw(const ImageView& left, const FrameResult& result, std::span<const PointView> points) const;

 private:
  struct Follow {
    std::deque<Eigen::Vector3d> trail_world;  // newest last
    double speed_m_s = 0;
  };
  void draw_points(cv::Mat& picture, const FrameResult& result, std::span<const PointView> points) const;
  void draw_object(cv::Mat& picture, const FrameResult& result, const ObjectState& object) const;
  void draw_trail(cv::Mat& picture, const FrameResult& result, const ObjectState& object) const;
  void draw_banner(cv::Mat& banner, const FrameResult& result, std::span<const PointView> points) const;

  StereoRig rig_;
  std::map<BodyId, Follow> followed_;
  Timestamp previous_time_;
  bool has_previous_ = false;
};

}  // namespace pelorus
