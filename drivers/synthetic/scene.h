#pragma once
// What a synthetic dive consists of: camera, vehicle path, seabed, bodies, water, light, sensor. Read from a scene file
// (scene_file.h) or filled by a test. Frame: sea (x north, y east, z down, metres). Pure data.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/transform.h"
#include "drivers/synthetic/goals.h"
#include "drivers/synthetic/pose_path.h"

namespace pelorus::synthetic {

struct SceneCamera {
  int width_px = 1024;
  int height_px = 768;
  double f_px = 800;
  double baseline_m = 0.12;
  double rate_hz = 10;
  double look_down_rad = 1.2;  // 0 looks ahead along the vehicle's x, pi/2 straight down
  [[nodiscard]] double cx_px() const { return 0.5 * (width_px - 1); }
  [[nodiscard]] double cy_px() const { return 0.5 * (height_px - 1); }
  // Left camera in the vehicle (x forward, y starboard, z down), at its origin.
  [[nodiscard]] Rigid3 T_body_cam() const;
};

struct Seabed {
  double depth_m = 3.6;              // mean z of the seabed
  double relief_m = 0.35;            // height differences of the longest wave
  double relief_wavelength_m = 3.2;  // of the longest wave; each shorter one halves it
  int relief_octaves = 4;
  double rocks_per_m2 = 0.5;
  double rock_size_min_m = 0.1;
  double rock_size_max_m = 0.5;
  double contrast = 1;  // of the texture
  double brightness = 1;
};

enum class Shape { box, ellipsoid };

struct Body {
  std::string name;
  Shape shape = Shape::box;
  Eigen::Vector3d size_m = Eigen::Vector3d::Constant(0.5);  // full lengths of edges or axes
  double contrast = 1;
  double brightness = 1;
  PosePath path;
};

// Jaffe 1990 / McGlamery 1979 in their simplest form: direct light falls off exponentially, backscatter builds up.
struct Water {
  double attenuation_per_m = 0;      // of light coming from the scene
  double backscatter_per_m = 0;      // rate at which the veil saturates
  double veil = 0.4;                 // radiance of an infinitely thick veil; white diffuse surface = 1
  double blur_px_per_m = 0;          // sigma of forward scattering per metre of range
  double snow_per_m3 = 0;            // marine snow
  double snow_size_m = 0.004;        // diameter of a large flake
  double snow_drift_m_per_s = 0.05;  // with the current
};

struct Light {
  double ambient = 0.55;  // share of light without direction
  double daylight = 1;    // strength of light from the surface
  double carried = 0;     // strength of the vehicle's lamp, 1 = as bright as daylight at 3 m
  double beam_rad = 0.6;  // half angle of the lamp at which it falls to a half
  double shadow = 0;      // 0 none .. 1 black: shadows of bodies on the seabed
  double caustics = 0;    // relative brightness swing of the moving light net on the ground
  double caustics_size_m = 0.5;
};

struct Sensor {
  double gain = 230;           // grey levels per unit radiance
  double read_noise_grey = 1;  // standard deviation in the dark
  double shot_noise = 0.008;   // variance per grey level of signal [grey]
};

struct Scene {
  std::string name;
  std::uint64_t seed = 1;
  int frames = 90;
  SceneCamera camera;
  PosePath vehicle;
  Seabed seabed;
  std::vector<Body> bodies;  // those whose path moves are objects of the truth; the others are part of the world
  Water water;
  Light light;
  Sensor sensor;
  Goals goals;

  // Another world of the same kind: every random thing of the scene derives from the seed.
  void reseed(std::uint64_t new_seed);
  [[nodiscard]] double time_s(int frame) const { return static_cast<double>(frame) / camera.rate_hz; }
  // Rectified left camera in the sea.
  [[nodiscard]] Rigid3 T_sea_cam(int frame) const;
};

}  // namespace pelorus::synthetic
