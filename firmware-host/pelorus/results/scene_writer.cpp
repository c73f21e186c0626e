#include "firmware-host/pelorus/results/scene_writer.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <optional>

namespace pelorus {
namespace {

// The frame in which all views of a body's points agree; absent where this step did not measure it.
std::optional<Rigid3> T_body_cam(const FrameResult& result, BodyId body) {
  if (!result.pose_valid) return std::nullopt;
  if (body == kWorldBody) return result.T_world_cam;
  for (const ObjectState& object : result.objects_view()) {
    if (object.id == body && object.motion_measured) return object.T_world_obj.inverse() * result.T_world_cam;
  }
  return std::nullopt;
}

int gray_at(const ImageView& image, const Eigen::Vector3d& z_px) {
  const int u = std::clamp(static_cast<int>(std::lround(z_px.x())), 0, image.width - 1);
  const int v = std::clamp(static_cast<int>(std::lround(z_px.y())), 0, image.height - 1);
  return image.row(v)[u];
}

}  // namespace

Result<SceneWriter> SceneWriter::create(const std::filesystem::path& folder, const StereoRig& rig) {
  const ResultPaths paths(folder);
  SceneWriter writer;
  writer.rig_ = rig;
  Result<ResultFile> points =
      ResultFile::create(paths.points, "object_id,track,p_x,p_y,p_z,spread_m,views,first_ns,last_ns,gray");
  if (!points) return points.error();
  writer.points_ = std::move(points.value());
  Result<ResultFile> outlines = ResultFile::create(paths.outlines, "timestamp_ns,object_id,p_x,p_y,p_z");
  if (!outlines) return outlines.error();
  writer.outlines_ = std::move(outlines.value());
  return writer;
}

void SceneWriter::observe(const FrameResult& result, const PointView& point, const ImageView& left) {
  const auto known = followed_.find(point.track);
  if (known != followed_.end()) known->second.last_step = step_;
  // A point without a body in this step may be back in its body in the next: it is followed on, but not measured.
  const std::optional<Rigid3> T = T_body_cam(result, point.body);
  const double z_m = point.curr.p_cam.z();
  if (!T || !(z_m > 0)) return;
  const Eigen::Vector3d p_body = *T * point.curr.p_cam;
  if (known != followed_.end() && known->second.body != point.body) {
    write_point(point.track, known->second);
    followed_.erase(known);
  }
  Followed& followed = followed_[point.track];
  if (followed.views == 0) {
    followed.body = point.body;
    followed.first_view = p_body;
    followed.first_seen = result.capture_time;
  }
  // Depth is what a view knows least: its variance grows with the fourth power of the depth (sigma_z of the rig).
  const double sigma_z_m = rig_.depth_sigma_m(z_m, 1.0);
  const double weight = 1.0 / (sigma_z_m * sigma_z_m);
  const Eigen::Vector3d from_first = p_body - followed.first_view;
  followed.weight += weight;
  followed.sum += weight * from_first;
  followed.sum_of_squares += weight * from_first.squaredNorm();
  followed.gray_sum += gray_at(left, point.curr.z_px);
  followed.last_seen = result.capture_time;
  followed.last_step = step_;
  ++followed.views;
}

void SceneWriter::write_point(TrackId track, const Followed& followed) {
  if (followed.views < kFewestViews) return;
  const Eigen::Vector3d offset = followed.sum / followed.weight;
  const Eigen::Vector3d p_body = followed.first_view + offset;
  const double variance_m2 = std::max(0.0, followed.sum_of_squares / followed.weight - offset.squaredNorm());
  std::fprintf(points_.get(), "%d,%" PRIu64 ",%.7g,%.7g,%.7g,%.3g,%d,%" PRId64 ",%" PRId64 ",%d\n", followed.body.value,
               track.value, p_body.x(), p_body.y(), p_body.z(), std::sqrt(variance_m2), followed.views,
               followed.first_seen.ns, followed.last_seen.ns,
               static_cast<int>(followed.gray_sum / static_cast<std::int64_t>(followed.views)));
}

void SceneWriter::write_outline(const FrameResult& result, const ObjectState& object) {
  if (!result.pose_valid || !object.motion_measured) return;
  const double z_m = (result.T_world_cam.inverse() * object.centroid_world).z();
  if (!(z_m > 0)) return;
  const Rigid3 T_obj_cam = object.T_world_obj.inverse() * result.T_world_cam;
  const double disparity_px = rig_.f_px * rig_.baseline_m / z_m;
  for (int i = 0; i < object.outline_size; ++i) {
    const OutlinePoint& corner = object.outline[static_cast<std::size_t>(i)];
    const double u_px = static_cast<double>(corner.u_px);
    const Eigen::Vector3d z_px(u_px, static_cast<double>(corner.v_px), u_px - disparity_px);
    const Eigen::Vector3d p_obj = T_obj_cam * rig_.triangulate(z_px);
    std::fprintf(outlines_.get(), "%" PRId64 ",%d,%.5g,%.5g,%.5g\n", result.capture_time.ns, object.id.value, p_obj.x(),
                 p_obj.y(), p_obj.z());
  }
}

Result<Ok> SceneWriter::append(const FrameResult& result, std::span<const PointView> points, const ImageView& left) {
  ++step_;
  for (const PointView& point : points) observe(result, point, left);
  for (auto entry = followed_.begin(); entry != followed_.end();) {
    if (entry->second.last_step == step_) {
      ++entry;
      continue;
    }
    write_point(entry->first, entry->second);
    entry = followed_.erase(entry);
  }
  for (const ObjectState& object : result.objects_view()) write_outline(result, object);
  if (Result<Ok> flushed = points_.flush(); !flushed) return flushed.error();
  return outlines_.flush();
}

Result<Ok> SceneWriter::finish() {
  for (const auto& [track, followed] : followed_) write_point(track, followed);
  followed_.clear();
  return points_.flush();
}

}  // namespace pelorus
