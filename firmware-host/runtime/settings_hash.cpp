#include "firmware-host/runtime/settings_hash.h"

#include <array>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "firmware-host/runtime/config_fields.h"

namespace pelorus {
namespace {

std::string number_text(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value == 0 ? 0.0 : value);
  return text.data();
}

std::string hash_of(const std::string& text) {
  std::uint64_t hash = 1469598103934665603U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016" PRIx64, hash);
  return digits.data();
}

std::string value_text(const ConfigField& field) {
  if (bool* const* flag = std::get_if<bool*>(&field.value)) return **flag ? "true" : "false";
  if (int* const* whole = std::get_if<int*>(&field.value)) return std::to_string(**whole);
  if (float* const* number = std::get_if<float*>(&field.value)) return number_text(static_cast<double>(**number));
  if (double* const* number = std::get_if<double*>(&field.value)) return number_text(**number);
  return "'" + *std::get<std::string*>(field.value) + "'";
}

std::vector<std::string> settings_text(ServiceConfig config) {
  std::vector<std::string> lines;
  std::vector<ConfigField> fields = service_fields(config);
  for (ConfigField& field : config_fields(config.pipeline)) fields.push_back(std::move(field));
  for (const ConfigField& field : fields) {
    lines.push_back(std::string(field.section) + "." + std::string(field.key) + "=" + value_text(field));
  }
  return lines;
}

void append(std::string& text, const CameraIntrinsics& camera) {
  text += std::to_string(camera.width) + "x" + std::to_string(camera.height) + " ";
  for (const double value : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) text += number_text(value) + " ";
  text += std::to_string(static_cast<int>(camera.lens)) + " ";
  for (const double value : camera.distortion) text += number_text(value) + " ";
}

}  // namespace

std::string config_hash(const ServiceConfig& config) {
  std::string text;
  for (const std::string& line : settings_text(config)) text += line + "\n";
  return hash_of(text);
}

std::string calibration_hash(const StereoCalibration& calibration) {
  std::string text;
  append(text, calibration.left);
  append(text, calibration.right);
  for (const Rigid3* T : {&calibration.T_right_left, &calibration.T_body_left}) {
    for (int i = 0; i < 12; ++i) text += number_text(T->matrix()(i / 4, i % 4)) + " ";
  }
  return hash_of(text + (calibration.rectified ? "rectified" : "raw"));
}

std::string changed_settings(const ServiceConfig& config) {
  const std::vector<std::string> now = settings_text(config);
  const std::vector<std::string> defaults = settings_text(ServiceConfig{});
  std::string text;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i] != defaults[i]) text += (text.empty() ? "" : ", ") + now[i];
  }
  return text;
}

}  // namespace pelorus
