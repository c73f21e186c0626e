#include "core/frontend/surf.h"

#include <cmath>

#include "core/base/check.h"
#include "core/frontend/surf_scale_space.h"
#include "core/kernels/surf_patch.h"

namespace pelorus {

struct Surf::State {
  State(const SurfConfig& c, int width, int height)
      : config(c), integral(width, height, c.sampling_step), scale_space(c, width, height) {
    points.reserve(static_cast<std::size_t>(c.max_points));
  }
  SurfConfig config;
  IntegralImage integral;
  SurfScaleSpace scale_space;
  std::vector<SurfPoint> points;
};

Surf::Surf(const SurfConfig& config, int width, int height) : state_(std::make_unique<State>(config, width, height)) {}
Surf::~Surf() = default;
Surf::Surf(Surf&&) noexcept = default;
Surf& Surf::operator=(Surf&&) noexcept = default;

std::span<const SurfPoint> Surf::detect(const ImageView& image) {
  State& s = *state_;
  s.integral.build(image);
  s.scale_space.build(s.integral);
  const std::span<const SurfPoint> found = s.scale_space.find_maxima(s.integral);
  s.points.assign(found.begin(), found.end());
  if (!s.config.upright) {
    for (SurfPoint& p : s.points) p.angle_rad = surf_orientation(s.integral, p.u_px, p.v_px, p.scale);
  }
  return s.points;
}

void Surf::describe(std::span<const SurfPoint> points, std::span<SurfDescriptor> out) const {
  PELORUS_CHECK(out.size() >= points.size(), "too little room for descriptors");
  const State& s = *state_;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfPoint& p = points[i];
    if (s.config.upright) {
      describe_upright(s.integral, p.u_px, p.v_px, p.scale, out[i]);
    } else {
      describe_rotated(s.integral, p.u_px, p.v_px, p.scale, p.angle_rad, out[i]);
    }
  }
}

}  // namespace pelorus
