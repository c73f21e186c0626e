#include "drivers/synthetic/scene_file.h"

#include <fstream>
#include <numbers>
#include <sstream>

#include "drivers/synthetic/strict_yaml.h"

namespace pelorus::synthetic {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

void read_degrees(StrictMap& map, const std::string& key, Limits limits_deg, double& value_rad) {
  double value_deg = value_rad / kRadPerDeg;
  map.number(key, limits_deg, value_deg);
  if (map.has(key)) value_rad = value_deg * kRadPerDeg;
}

void read_camera(StrictMap& map, SceneCamera& camera) {
  map.integer("width_px", {64, 4096}, camera.width_px);
  map.integer("height_px", {64, 4096}, camera.height_px);
  map.number("f_px", {50, 10000}, camera.f_px);
  map.number("baseline_m", {0.01, 2}, camera.baseline_m);
  map.number("rate_hz", {0.5, 200}, camera.rate_hz);
  read_degrees(map, "look_down_deg", {0, 90}, camera.look_down_rad);
}

void read_path(StrictMap& map, PosePath& path) {
  map.require("p_m");
  map.number("step_s", {0.05, 1000}, path.step_s);
  map.vectors3("p_m", {-1000, 1000}, path.p_sea);
  std::vector<Eigen::Vector3d> rpy_deg{Eigen::Vector3d::Zero()};
  map.vectors3("rpy_deg", {-36000, 36000}, rpy_deg);
  if (rpy_deg.size() != 1 && rpy_deg.size() != path.p_sea.size())
    map.problem("rpy_deg", "has " + std::to_string(rpy_deg.size()) + " entries: give one for all, or one for each of " +
                               std::to_string(path.p_sea.size()) + " in p_m");
  path.rpy_rad.clear();
  for (const Eigen::Vector3d& rpy : rpy_deg) path.rpy_rad.push_back(rpy * kRadPerDeg);
  map.number("sway_m", {0, 1}, path.sway.amplitude_m);
  read_degrees(map, "sway_deg", {0, 30}, path.sway.amplitude_rad);
  map.number("sway_period_s", {0.5, 100}, path.sway.period_s);
}

void read_seabed(StrictMap& map, Seabed& seabed) {
  map.number("depth_m", {0.2, 100}, seabed.depth_m);
  map.number("relief_m", {0, 5}, seabed.relief_m);
  map.number("relief_wavelength_m", {0.2, 100}, seabed.relief_wavelength_m);
  map.integer("relief_octaves", {1, 6}, seabed.relief_octaves);
  map.number("rocks_per_m2", {0, 5}, seabed.rocks_per_m2);
  map.number("rock_size_min_m", {0.02, 5}, seabed.rock_size_min_m);
  map.number("rock_size_max_m", {0.02, 5}, seabed.rock_size_max_m);
  if (seabed.rock_size_max_m < seabed.rock_size_min_m)
    map.problem("rock_size_max_m", "is below rock_size_min_m: exchange them");
  map.number("contrast", {0, 3}, seabed.contrast);
  map.number("brightness", {0.1, 2}, seabed.brightness);
}

void read_body(StrictMap& map, std::size_t index, Body& body) {
  body.name = "body" + std::to_string(index);
  map.text("name", body.name);
  std::string shape = "box";
  map.text("shape", shape);
  if (shape != "box" && shape != "ellipsoid") map.problem("shape", "is '" + shape + "': use box or ellipsoid");
  body.shape = shape == "ellipsoid" ? Shape::ellipsoid : Shape::box;
  map.require("size_m");
  map.vector3("size_m", {0.01, 50}, body.size_m);
  map.number("contrast", {0, 3}, body.contrast);
  map.number("brightness", {0.1, 2}, body.brightness);
  map.require("path");
  map.map("path", [&](StrictMap& path) { read_path(path, body.path); });
}

void read_water(StrictMap& map, Water& water) {
  map.number("attenuation_per_m", {0, 5}, water.attenuation_per_m);
  map.number("backscatter_per_m", {0, 5}, water.backscatter_per_m);
  map.number("veil", {0, 2}, water.veil);
  map.number("blur_px_per_m", {0, 3}, water.blur_px_per_m);
  map.number("snow_per_m3", {0, 5000}, water.snow_per_m3);
  map.number("snow_size_m", {0.0001, 0.1}, water.snow_size_m);
  map.number("snow_drift_m_per_s", {0, 2}, water.snow_drift_m_per_s);
}

void read_light(StrictMap& map, Light& light) {
  map.number("ambient", {0, 1}, light.ambient);
  map.number("daylight", {0, 5}, light.daylight);
  map.number("carried", {0, 5}, light.carried);
  read_degrees(map, "beam_deg", {3, 89}, light.beam_rad);
  map.number("shadow", {0, 1}, light.shadow);
  map.number("caustics", {0, 1}, light.caustics);
  map.number("caustics_size_m", {0.05, 20}, light.caustics_size_m);
}

void read_sensor(StrictMap& map, Sensor& sensor) {
  map.number("gain", {1, 10000}, sensor.gain);
  map.number("read_noise_grey", {0, 50}, sensor.read_noise_grey);
  map.number("shot_noise", {0, 5}, sensor.shot_noise);
}

void read_scene(StrictMap& map, Scene& scene) {
  map.text("name", scene.name);
  map.seed("seed", scene.seed);
  map.integer("frames", {1, 1000000}, scene.frames);
  map.map("camera", [&](StrictMap& camera) { read_camera(camera, scene.camera); });
  map.require("vehicle");
  map.map("vehicle", [&](StrictMap& vehicle) { read_path(vehicle, scene.vehicle); });
  map.map("seabed", [&](StrictMap& seabed) { read_seabed(seabed, scene.seabed); });
  map.list("bodies", [&](StrictMap& body, std::size_t index) {
    scene.bodies.emplace_back();
    read_body(body, index, scene.bodies.back());
  });
  map.map("water", [&](StrictMap& water) { read_water(water, scene.water); });
  map.map("light", [&](StrictMap& light) { read_light(light, scene.light); });
  map.map("sensor", [&](StrictMap& sensor) { read_sensor(sensor, scene.sensor); });
  map.map("goals", [&](StrictMap& goals) { read_goals(goals, scene.goals); });
  scene.reseed(scene.seed);
}

}  // namespace

Result<Scene> parse_scene(const std::string& yaml, const std::string& name) {
  Scene scene;
  Problems problems(name);
  try {
    StrictMap map(YAML::Load(yaml), "", problems);
    read_scene(map, scene);
  } catch (const YAML::Exception& e) {
    problems.add(e.mark, "not valid YAML: " + e.msg);
  }
  if (problems.none()) return scene;
  return Error{ErrorCode::bad_configuration, "", problems.text(), ""};
}

Result<Scene> load_scene(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file) return Error{ErrorCode::io, path, "cannot be read", "give the path of a scene file, a YAML text"};
  return parse_scene(text.str(), path);
}

}  // namespace pelorus::synthetic
