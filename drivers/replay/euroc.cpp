#include "drivers/replay/euroc.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string_view>

#include "drivers/replay/calibration_yaml.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && (s.back() == '\r' || s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  return s;
}

bool parse_ns(std::string_view s, std::int64_t& ns) {
  const auto [end, status] = std::from_chars(s.data(), s.data() + s.size(), ns);
  return status == std::errc() && end == s.data() + s.size();
}

Result<std::vector<RecordedImage>> read_data_csv(const fs::path& camera_folder) {
  const fs::path csv = camera_folder / "data.csv";
  std::ifstream in(csv);
  if (!in) return Error{ErrorCode::io, csv.string(), "cannot be read", "check its permissions"};
  std::vector<RecordedImage> images;
  std::vector<int> lines;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    const std::size_t comma = content.find(',');
    RecordedImage image;
    if (!parse_ns(trimmed(content.substr(0, comma)), image.time.ns))
      return Error{ErrorCode::bad_input, csv.string() + ":" + std::to_string(number),
                   "'" + std::string(content) + "' does not start with a time stamp in nanoseconds",
                   "expected: timestamp_ns,filename"};
    const std::string_view name = comma == std::string_view::npos ? "" : trimmed(content.substr(comma + 1));
    image.file = camera_folder / "data" / (name.empty() ? std::to_string(image.time.ns) + ".png" : std::string(name));
    image.index = static_cast<std::int64_t>(images.size());
    images.push_back(std::move(image));
    lines.push_back(number);
  }
  const OrderCure cure{"remove one of the two lines", "sort the lines by time"};
  const auto place = [&](std::size_t i) { return csv.string() + ":" + std::to_string(lines[i]); };
  if (auto order = check_order(images, cure, place); !order) return order.error();
  return images;
}

// Without a list the file names are the time stamps.
Result<std::vector<RecordedImage>> read_names(const fs::path& camera_folder) {
  std::vector<RecordedImage> images;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(camera_folder / "data", failed)) {
    RecordedImage image;
    if (!parse_ns(entry.path().stem().string(), image.time.ns)) continue;
    image.file = entry.path();
    images.push_back(std::move(image));
  }
  if (failed)
    return Error{ErrorCode::bad_input, (camera_folder / "data").string(), "cannot be listed: " + failed.message(),
                 "an EuRoC camera folder holds data.csv and data/"};
  std::sort(images.begin(), images.end(),
            [](const auto& a, const auto& b) { return a.time != b.time ? a.time < b.time : a.file < b.file; });
  const OrderCure cure{"keep one image of each time", "name the images by their times"};
  if (auto order = check_order(images, cure, [&](std::size_t i) { return images[i].file.string(); }); !order)
    return order.error();
  return images;
}

Result<std::vector<RecordedImage>> list_camera(const fs::path& camera_folder) {
  std::error_code ignored;
  auto images =
      fs::exists(camera_folder / "data.csv", ignored) ? read_data_csv(camera_folder) : read_names(camera_folder);
  if (!images) return images;
  if (auto present = mark_absent(images.value(), camera_folder / "data"); !present) return present.error();
  return images;
}

Result<> read_sensor(const fs::path& file, CameraIntrinsics& camera, Rigid3& T_body_camera) {
  auto loaded = read_calibration_yaml(file);
  if (!loaded) return loaded.error();
  const CalibrationYaml& yaml = loaded.value();
  const auto size = numbers(yaml, yaml.root, "resolution", 2, 2);
  if (!size) return size.error();
  const auto k = numbers(yaml, yaml.root, "intrinsics", 4, 4);
  if (!k) return k.error();
  const auto pose = numbers(yaml, yaml.root, "T_BS", 16, 16);
  if (!pose) return pose.error();
  camera.width = static_cast<int>(size.value()[0]);
  camera.height = static_cast<int>(size.value()[1]);
  camera.fx_px = k.value()[0];
  camera.fy_px = k.value()[1];
  camera.cx_px = k.value()[2];
  camera.cy_px = k.value()[3];
  const YAML::Node model = child(yaml.root, "distortion_model");
  std::vector<double> coefficients;
  if (model.IsDefined() && child(yaml.root, "distortion_coefficients").IsDefined()) {
    auto read = numbers(yaml, yaml.root, "distortion_coefficients", 0, 8);
    if (!read) return read.error();
    coefficients = std::move(read.value());
  }
  const std::string name = model.IsDefined() && model.IsScalar() ? model.Scalar() : "none";
  if (auto lens = set_lens(camera, name, coefficients, model.IsDefined() ? yaml.place(model) : yaml.file); !lens)
    return lens;
  auto T = rigid_from_rows(pose.value(), yaml.place(child(yaml.root, "T_BS")));
  if (!T) return T.error();
  T_body_camera = T.value();
  return Ok{};
}

}  // namespace

fs::path find_euroc(const fs::path& path) {
  std::error_code ignored;
  for (const fs::path& folder : {path / "mav0", path})
    if (fs::is_directory(folder / "cam0", ignored)) return folder;
  return {};
}

Result<Recording> list_euroc(const fs::path& mav0) {
  Recording recording{"EuRoC ASL", mav0, {}, {}, {}, {}, [mav0] { return read_euroc_calibration(mav0); }};
  std::error_code ignored;
  if (!fs::is_directory(mav0 / "cam1", ignored))
    return Error{ErrorCode::bad_input, mav0.string(), "has cam0 but no cam1", "a stereo data set needs both cameras"};
  auto left = list_camera(mav0 / "cam0");
  if (!left) return left.error();
  auto right = list_camera(mav0 / "cam1");
  if (!right) return right.error();
  recording.left = std::move(left.value());
  recording.right = std::move(right.value());
  for (const char* list : {"cam0/data.csv", "cam1/data.csv"}) {
    if (fs::exists(mav0 / list, ignored))
      recording.listed_in += (recording.listed_in.empty() ? "" : " and ") + std::string(list);
  }
  return recording;
}

Result<LoadedCalibration> read_euroc_calibration(const fs::path& mav0) {
  LoadedCalibration out;
  StereoCalibration& c = out.calibration;
  Rigid3 T_body_right;
  if (auto left = read_sensor(mav0 / "cam0" / "sensor.yaml", c.left, c.T_body_left); !left) return left.error();
  if (auto right = read_sensor(mav0 / "cam1" / "sensor.yaml", c.right, T_body_right); !right) return right.error();
  c.T_right_left = T_body_right.inverse() * c.T_body_left;
  c.body_known = true;
  out.origin = "EuRoC sensor.yaml of " + mav0.string();
  out.assumptions = {"cam0 is the left camera, cam1 the right one",
                     "T_BS maps camera coordinates to body coordinates (T_body_camera)"};
  if (auto checked = check_calibration(c, (mav0 / "cam1" / "sensor.yaml").string()); !checked) return checked.error();
  return out;
}

}  // namespace pelorus
