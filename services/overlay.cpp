#include "services/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "services/body_colors.h"

namespace pelorus {
namespace {

constexpr std::size_t kTrailLength = 30;  // frames
constexpr int kShift = 4;                 // sub-pixel bits of OpenCV's drawing coordinates

const cv::Scalar kUnexplainedColor(255, 255, 255);
const cv::Scalar kBannerColor(34, 30, 26);
const cv::Scalar kTextColor(235, 235, 235);
const cv::Scalar kQuietTextColor(165, 165, 160);

cv::Scalar bgr(Rgb color) { return {1.0 * color.blue, 1.0 * color.green, 1.0 * color.red}; }

cv::Point fixed_point(double u_px, double v_px) {
  constexpr double kScale = 1 << kShift;
  return {static_cast<int>(std::lround(u_px * kScale)), static_cast<int>(std::lround(v_px * kScale))};
}

void dot(cv::Mat& picture, double u_px, double v_px, double radius_px, const cv::Scalar& color) {
  const int radius = static_cast<int>(std::lround(radius_px * (1 << kShift)));
  cv::circle(picture, fixed_point(u_px, v_px), radius, color, cv::FILLED, cv::LINE_AA, kShift);
}

// Text height follows the picture's height, within what stays readable.
double text_scale(int height_px) { return std::clamp(height_px / 1400.0, 0.4, 0.75); }

int text_width(const std::string& text, double scale, int thickness) {
  int baseline = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, scale, thickness, &baseline).width;
}

void put_text(cv::Mat& picture, const std::string& text, cv::Point origin, double scale, const cv::Scalar& color) {
  cv::putText(picture, text, origin, cv::FONT_HERSHEY_DUPLEX, scale, color, 1, cv::LINE_AA);
}

// A darkened plate under the text, so that it reads on any background.
void shade(cv::Mat& picture, cv::Rect plate) {
  plate &= cv::Rect(0, 0, picture.cols, picture.rows);
  if (plate.empty()) return;
  cv::Mat region = picture(plate);
  cv::addWeighted(region, 0.3, cv::Mat(region.size(), region.type(), kBannerColor), 0.7, 0, region);
}

bool is_labelled(const ObjectState& object) {
  return object.phase == ObjectPhase::confirmed || object.phase == ObjectPhase::coasting;
}

std::string label_text(const ObjectState& object, double range_m, double speed_m_s) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "#%d  %.2f m  %.2f m/s%s", object.id.value, range_m, speed_m_s,
                object.phase == ObjectPhase::coasting ? "  coasting" : "");
  return text.data();
}

std::vector<cv::Point> outline_polygon(const ObjectState& object) {
  std::vector<cv::Point> polygon;
  for (int i = 0; i < object.outline_size; ++i) {
    const OutlinePoint& corner = object.outline[static_cast<std::size_t>(i)];
    polygon.push_back(fixed_point(static_cast<double>(corner.u_px), static_cast<double>(corner.v_px)));
  }
  return polygon;
}

// Coasting objects are drawn with gaps: what is shown there is extrapolated.
void draw_outline(cv::Mat& picture, const std::vector<cv::Point>& polygon, const cv::Scalar& color, bool dashed) {
  if (!dashed) {
    cv::polylines(picture, polygon, true, color, 2, cv::LINE_AA, kShift);
    return;
  }
  constexpr double kDash = 6.0 * (1 << kShift);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const cv::Point2d from = polygon[i];
    const cv::Point2d step = cv::Point2d(polygon[(i + 1) % polygon.size()]) - from;
    const int dashes = std::max(1, static_cast<int>(std::hypot(step.x, step.y) / (2 * kDash)));
    for (int d = 0; d < dashes; ++d) {
      const cv::Point2d a = from + step * (d / static_cast<double>(dashes));
      const cv::Point2d b = from + step * ((d + 0.5) / static_cast<double>(dashes));
      cv::line(picture, cv::Point(a), cv::Point(b), color, 2, cv::LINE_AA, kShift);
    }
  }
}

}  // namespace

void Overlay::observe(const FrameResult& result, Duration step) {
  const Duration spanned = step.count() > 0 ? step : has_previous_ ? result.capture_time - previous_time_ : Duration{};
  const double dt_s = seconds(spanned);
  for (const ObjectState& object : result.objects_view()) {
    if (object.phase == ObjectPhase::ended) {
      followed_.erase(object.id);
      continue;
    }
    Follow& follow = followed_[object.id];
    // The object's own origin: the centroid of the seen points jumps as points come and go.
    follow.trail_world.push_back(object.T_world_obj.translation());
    if (follow.trail_world.size() > kTrailLength) follow.trail_world.pop_front();
    const Eigen::Vector3d step_world = object.centroid_world - object.M_world.inverse() * object.centroid_world;
    // A step's speed jumps with its noise; the label wants to be read.
    const double speed = dt_s > 0 ? step_world.norm() / dt_s : 0;
    const bool first = follow.trail_world.size() <= 2;
    follow.speed_m_s = first ? speed : 0.8 * follow.speed_m_s + 0.2 * speed;
  }
  previous_time_ = result.capture_time;
  has_previous_ = true;
}

void Overlay::draw_points(cv::Mat& picture, const FrameResult& result, std::span<const PointView> points) const {
  const auto is_published = [&](BodyId body) {
    const auto objects = result.objects_view();
    return std::any_of(objects.begin(), objects.end(),
                       [&](const ObjectState& object) { return object.id == body && is_labelled(object); });
  };
  const double unit = std::max(1.0, picture.rows / 480.0);
  for (const PointView& point : points) {
    const double u_px = point.curr.z_px.x();
    const double v_px = point.curr.z_px.y();
    if (point.body == kWorldBody) {
      dot(picture, u_px, v_px, 1.5 * unit, bgr(kStaticColor));
    } else if (point.body == kNoBody) {
      dot(picture, u_px, v_px, 1.6 * unit, cv::Scalar(0, 0, 0));
      dot(picture, u_px, v_px, 1.1 * unit, kUnexplainedColor);
    } else if (is_published(point.body)) {
      dot(picture, u_px, v_px, 2.5 * unit, cv::Scalar(0, 0, 0));
      dot(picture, u_px, v_px, 2.0 * unit, bgr(object_color(point.body)));
    } else {
      dot(picture, u_px, v_px, 1.5 * unit, bgr(object_color(point.body)) * 0.7);
    }
  }
}

void Overlay::draw_trail(cv::Mat& picture, const FrameResult& result, const ObjectState& object) const {
  const auto follow = followed_.find(object.id);
  if (follow == followed_.end() || !result.pose_valid) return;
  const Rigid3 T_cam_world = result.T_world_cam.inverse();
  bool has_last = false;
  cv::Point last;
  for (const Eigen::Vector3d& p_world : follow->second.trail_world) {
    const Eigen::Vector3d p_cam = T_cam_world * p_world;
    const bool in_front = p_cam.z() > 0.1;
    if (in_front) {
      const Eigen::Vector3d z_px = rig_.project(p_cam);
      const cv::Point now = fixed_point(std::clamp(z_px.x(), -2000.0, 4000.0), std::clamp(z_px.y(), -2000.0, 4000.0));
      if (has_last) cv::line(picture, last, now, bgr(object_color(object.id)), 1, cv::LINE_AA, kShift);
      last = now;
    }
    has_last = in_front;
  }
}

void Overlay::draw_object(cv::Mat& picture, const FrameResult& result, const ObjectState& object) const {
  const cv::Scalar color = bgr(object_color(object.id));
  const std::vector<cv::Point> polygon = outline_polygon(object);
  if (!is_labelled(object)) {
    if (!polygon.empty()) cv::polylines(picture, polygon, true, color * 0.6, 1, cv::LINE_AA, kShift);
    return;
  }
  draw_trail(picture, result, object);
  if (!polygon.empty()) draw_outline(picture, polygon, color, object.phase == ObjectPhase::coasting);

  const Eigen::Vector3d p_cam = result.T_world_cam.inverse() * object.centroid_world;
  if (p_cam.z() <= 0.1) return;
  const Eigen::Vector3d z_px = rig_.project(p_cam);
  double left_px = z_px.x();
  double top_px = z_px.y();
  for (const cv::Point& corner : polygon) {
    left_px = std::min(left_px, corner.x / static_cast<double>(1 << kShift));
    top_px = std::min(top_px, corner.y / static_cast<double>(1 << kShift));
  }
  const auto follow = followed_.find(object.id);
  const double speed_m_s = follow == followed_.end() ? 0 : follow->second.speed_m_s;
  const std::string label = label_text(object, p_cam.norm(), speed_m_s);
  const double scale = text_scale(picture.rows);
  const int height = static_cast<int>(34 * scale);
  const int width = text_width(label, scale, 1) + 16;
  cv::Rect plate(static_cast<int>(left_px), static_cast<int>(top_px) - height - 4, width, height);
  plate.x = std::clamp(plate.x, 0, std::max(0, picture.cols - width));
  plate.y = std::clamp(plate.y, 0, std::max(0, picture.rows - height));
  shade(picture, plate);
  cv::rectangle(picture, cv::Rect(plate.x, plate.y, 4, height), color, cv::FILLED);
  put_text(picture, label, {plate.x + 10, plate.y + height - static_cast<int>(11 * scale)}, scale, kTextColor);
}

void Overlay::draw_banner(cv::Mat& banner, const FrameResult& result, std::span<const PointView> points) const {
  const double scale = text_scale(banner.cols * 3 / 4);
  const int base = (banner.rows + static_cast<int>(22 * scale)) / 2;
  const std::string state = to_text(result.state);
  const int chip_width = text_width(state, scale, 1) + 20;
  cv::rectangle(banner, cv::Rect(0, 0, chip_width, banner.rows), bgr(state_color(result.state)), cv::FILLED);
  put_text(banner, state, {10, base}, scale, cv::Scalar(255, 255, 255));

  const auto count = [&](auto&& wanted) { return std::count_if(points.begin(), points.end(), wanted); };
  const auto static_points = count([](const PointView& p) { return p.body == kWorldBody; });
  const auto unexplained = count([](const PointView& p) { return p.body == kNoBody; });
  const auto objects = result.objects_view();
  const auto labelled = std::count_if(objects.begin(), objects.end(), is_labelled);
  const std::string text = std::to_string(labelled) + (labelled == 1 ? " object" : " objects");
  put_text(banner, text, {chip_width + 16, base}, scale, kTextColor);
  const int quiet_from = chip_width + 16 + text_width(text, scale, 1) + 24;
  const std::string counts = std::to_string(static_points) + " static  " +
                             std::to_string(static_cast<long>(points.size()) - static_points - unexplained) +
                             " moving  " + std::to_string(unexplained) + " unexplained";
  put_text(banner, counts, {quiet_from, base}, scale, kQuietTextColor);
  std::array<char, 64> frame_text{};
  std::snprintf(frame_text.data(), frame_text.size(), "world %.0f%%   frame %llu", 100 * result.world_confidence,
                static_cast<unsigned long long>(result.seq));
  const std::string frame = frame_text.data();
  put_text(banner, frame, {banner.cols - text_width(frame, scale, 1) - 12, base}, scale, kQuietTextColor);
}

cv::Mat Overlay::draw(const ImageView& left, const FrameResult& result, std::span<const PointView> points) const {
  const int banner_height = std::clamp(left.width / 26, 26, 48);
  cv::Mat canvas(left.height + banner_height, left.width, CV_8UC3, kBannerColor);
  cv::Mat picture = canvas(cv::Rect(0, banner_height, left.width, left.height));
  // const_cast: OpenCV has no view of constant pixels; nothing writes through it.
  const cv::Mat grey(left.height, left.width, CV_8UC1, const_cast<std::uint8_t*>(left.pixels),
                     static_cast<std::size_t>(left.stride));
  cv::Mat dimmed;
  grey.convertTo(dimmed, CV_8U, 0.85);  // a little darker: colours stand out
  cv::cvtColor(dimmed, picture, cv::COLOR_GRAY2BGR);
  draw_points(picture, result, points);
  for (const ObjectState& object : result.objects_view()) {
    if (object.phase != ObjectPhase::ended) draw_object(picture, result, object);
  }
  cv::Mat banner = canvas(cv::Rect(0, 0, left.width, banner_height));
  draw_banner(banner, result, points);
  return canvas;
}

}  // namespace pelorus
