#include "drivers/replay/calibration_yaml.h"

#include <Eigen/LU>
#include <algorithm>
#include <fstream>
#include <iterator>

namespace pelorus {
namespace {

Error refuse(const std::string& place, std::string detail, std::string cure) {
  return Error{ErrorCode::bad_calibration, place, std::move(detail), std::move(cure)};
}

bool append_numbers(const YAML::Node& node, std::vector<double>& out) {
  if (node.IsSequence()) {
    for (const auto& entry : node)
      if (!append_numbers(entry, out)) return false;
    return true;
  }
  if (!node.IsScalar()) return false;
  double value = 0;
  if (!YAML::convert<double>::decode(node, value)) return false;
  out.push_back(value);
  return true;
}

}  // namespace

std::string CalibrationYaml::place(const YAML::Node& node) const {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
}

Result<std::string> read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code ignored;
  if (!in || std::filesystem::is_directory(path, ignored))
    return Error{ErrorCode::io, path.string(), "cannot be read", "check that the file exists and its permissions"};
  return std::string(std::istreambuf_iterator<char>(in), {});
}

Result<CalibrationYaml> read_calibration_yaml(const std::filesystem::path& path) {
  auto content = read_text(path);
  if (!content) return content.error();
  std::string& yaml_text = content.value();
  // Spaces instead of removal: line numbers stay true.
  if (yaml_text.starts_with("%YAML"))
    std::fill(yaml_text.begin(),
              yaml_text.begin() + static_cast<std::ptrdiff_t>(std::min(yaml_text.find('\n'), yaml_text.size())), ' ');
  try {
    CalibrationYaml yaml{path.string(), YAML::Load(yaml_text)};
    if (yaml.root.IsMap()) return yaml;
    return refuse(path.string(), "holds no keys", "expected a calibration in YAML");
  } catch (const YAML::Exception& e) {
    return refuse(path.string() + ":" + std::to_string(e.mark.line + 1), "not valid YAML: " + e.msg,
                  "correct this line");
  }
}

YAML::Node child(const YAML::Node& map, const std::string& key) {
  if (!map.IsDefined() || !map.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  for (const auto& entry : map)
    if (entry.first.IsScalar() && entry.first.Scalar() == key) return entry.second;
  return YAML::Node(YAML::NodeType::Undefined);
}

Result<std::vector<double>> numbers(const CalibrationYaml& yaml, const YAML::Node& map, const std::string& key,
                                    std::size_t count_min, std::size_t count_max) {
  const YAML::Node node = child(map, key);
  if (!node.IsDefined())
    return refuse(yaml.place(map), "'" + key + "' is missing", "add it, or use a complete calibration file");
  std::vector<double> values;
  // OpenCV and EuRoC write a matrix as a map with its numbers under `data`.
  const YAML::Node list = node.IsMap() ? child(node, "data") : node;
  if (!list.IsDefined() || !append_numbers(list, values))
    return refuse(yaml.place(node), "'" + key + "' is not a list of numbers", "");
  if (values.size() < count_min || values.size() > count_max) {
    const std::string wanted = count_min == count_max ? std::to_string(count_min)
                                                      : std::to_string(count_min) + " to " + std::to_string(count_max);
    return refuse(yaml.place(node),
                  "'" + key + "' has " + std::to_string(values.size()) + " numbers instead of " + wanted,
                  "correct the matrix");
  }
  return values;
}

Result<std::string> text(const CalibrationYaml& yaml, const YAML::Node& map, const std::string& key) {
  const YAML::Node node = child(map, key);
  if (node.IsDefined() && node.IsScalar()) return node.Scalar();
  return refuse(yaml.place(map), "'" + key + "' is missing", "add it, or use a complete calibration file");
}

Result<> set_lens(CameraIntrinsics& camera, const std::string& model, const std::vector<double>& k,
                  const std::string& place) {
  struct Name {
    const char* name;
    LensKind lens;
  };
  static constexpr Name kNames[] = {{"none", LensKind::none},
                                    {"", LensKind::none},
                                    {"radtan", LensKind::radtan},
                                    {"radtan4", LensKind::radtan},
                                    {"radtan5", LensKind::radtan},
                                    {"radial-tangential", LensKind::radtan},
                                    {"plumb_bob", LensKind::radtan},
                                    {"rational", LensKind::rational},
                                    {"rational8", LensKind::rational},
                                    {"rational_polynomial", LensKind::rational},
                                    {"fisheye", LensKind::equidistant},
                                    {"equidistant", LensKind::equidistant},
                                    {"equidistant4", LensKind::equidistant},
                                    {"kannala_brandt", LensKind::equidistant},
                                    {"equi", LensKind::equidistant}};
  const auto* known =
      std::find_if(std::begin(kNames), std::end(kNames), [&](const Name& n) { return model == n.name; });
  if (known == std::end(kNames))
    return refuse(place, "unknown lens model '" + model + "'",
                  "use radtan (plumb_bob), rational (rational_polynomial), equidistant (kannala_brandt) or none");
  std::size_t used = k.size();
  while (used > 0 && k[used - 1] == 0) --used;  // trailing zeros change nothing
  camera.lens = known->lens;
  std::size_t room = 0;
  if (camera.lens == LensKind::radtan) room = 5;
  if (camera.lens == LensKind::rational) room = 8;
  if (camera.lens == LensKind::equidistant) room = 4;
  if (used > room)
    return refuse(
        place,
        "lens model '" + model + "' takes " + std::to_string(room) + " coefficients, not " + std::to_string(k.size()),
        "name the model that was calibrated, without thin-prism terms");
  camera.distortion = {};
  std::copy_n(k.begin(), used, camera.distortion.begin());
  if (used == 0 && camera.lens != LensKind::equidistant) camera.lens = LensKind::none;
  return Ok{};
}

Result<Rigid3> rigid_from_rows(const std::vector<double>& m, const std::string& place) {
  const Eigen::Matrix4d rows = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  Rigid3 T = Rigid3::Identity();
  T.linear() = rows.topLeftCorner<3, 3>();
  T.translation() = rows.topRightCorner<3, 1>();
  const double error = (T.linear() * T.linear().transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(error < 1e-3) || T.linear().determinant() < 0 || !T.translation().allFinite())
    return refuse(place, "the rotation part of the transform is not a rotation matrix", "check the sixteen numbers");
  return orthonormalized(T);
}

}  // namespace pelorus
