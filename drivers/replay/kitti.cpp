#include "drivers/replay/kitti.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "drivers/replay/calibration_yaml.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

Error input_error(const std::string& place, std::string detail, std::string cure) {
  return Error{ErrorCode::bad_input, place, std::move(detail), std::move(cure)};
}

bool parse_seconds(const std::string& line, Timestamp& time) {
  char* end = nullptr;
  const long double value_s = std::strtold(line.c_str(), &end);  // 64-bit mantissa: epoch seconds keep their ns
  if (end == line.c_str() || !std::isfinite(value_s)) return false;
  time.ns = std::llroundl(value_s * 1e9L);
  return line.find_first_not_of(" \t\r", static_cast<std::size_t>(end - line.c_str())) == std::string::npos;
}

// 2011-09-26 13:04:32.351950336
bool parse_date_time(const std::string& line, Timestamp& time) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, used = 0;
  if (std::sscanf(line.c_str(), "%d-%d-%d %d:%d:%d%n", &year, &month, &day, &hour, &minute, &second, &used) != 6)
    return false;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok() || hour > 23 || minute > 59 || second > 60) return false;
  std::int64_t fraction_ns = 0;
  std::size_t at = static_cast<std::size_t>(used);
  if (at < line.size() && line[at] == '.') {
    std::int64_t digit_ns = 100'000'000;
    for (++at; at < line.size() && line[at] >= '0' && line[at] <= '9'; ++at, digit_ns /= 10)
      fraction_ns += digit_ns * (line[at] - '0');
  }
  if (line.find_first_not_of(" \t\r", at) != std::string::npos) return false;
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  time.ns = (((days * 24 + hour) * 60 + minute) * 60 + second) * 1'000'000'000 + fraction_ns;
  return true;
}

using LineParser = bool (*)(const std::string&, Timestamp&);

// One time per line; line k belongs to image number k.
Result<std::vector<RecordedImage>> read_times(const fs::path& file, LineParser parse, const char* expected) {
  std::ifstream in(file);
  if (!in) return input_error(file.string(), "cannot be read", "a KITTI recording needs the time of every image there");
  std::vector<RecordedImage> times;
  std::string line;
  while (std::getline(in, line)) {
    RecordedImage image;
    image.index = static_cast<std::int64_t>(times.size());
    if (!parse(line, image.time)) {
      if (line.find_first_not_of(" \t\r") == std::string::npos && in.peek() == EOF) break;
      return input_error(file.string() + ":" + std::to_string(times.size() + 1), "'" + line + "' is not a time",
                         std::string("expected ") + expected);
    }
    times.push_back(std::move(image));
  }
  // A line removed or moved would give every image after it a wrong time.
  const std::string cure = "correct the time; keep the line, since line k holds the time of image k - 1";
  const auto place = [&](std::size_t i) { return file.string() + ":" + std::to_string(i + 1); };
  if (auto order = check_order(times, {cure, cure}, place); !order) return order.error();
  if (times.empty()) return input_error(file.string(), "holds no times", "one line per image is expected");
  return times;
}

// What `folder` should hold by the list of times; an image that is not there has no file.
Result<std::vector<RecordedImage>> list_images(const fs::path& folder, const std::vector<RecordedImage>& times,
                                               const fs::path& times_file) {
  std::vector<RecordedImage> images;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string stem = entry.path().stem().string();
    RecordedImage image;
    const auto [end, status] = std::from_chars(stem.data(), stem.data() + stem.size(), image.index);
    if (status != std::errc() || end != stem.data() + stem.size() || image.index < 0) continue;
    if (image.index >= static_cast<std::int64_t>(times.size()))
      return input_error(entry.path().string(),
                         "has no time: " + times_file.string() + " ends at line " + std::to_string(times.size()),
                         "use the complete file of times, or remove the image");
    image.time = times[static_cast<std::size_t>(image.index)].time;
    image.file = entry.path();
    images.push_back(std::move(image));
  }
  if (failed)
    return input_error(folder.string(), "cannot be listed: " + failed.message(),
                       "a stereo recording needs both cameras");
  if (images.empty()) return input_error(folder.string(), "holds no images", "copy the images of this camera");
  std::sort(images.begin(), images.end(),
            [](const auto& a, const auto& b) { return a.index != b.index ? a.index < b.index : a.file < b.file; });
  const OrderCure cure{"keep one image of each number", "correct " + times_file.string()};
  if (auto order = check_order(images, cure, [&](std::size_t i) { return images[i].file.string(); }); !order)
    return order.error();
  std::vector<RecordedImage> listed = times;
  for (RecordedImage& image : images) listed[static_cast<std::size_t>(image.index)].file = std::move(image.file);
  return listed;
}

Result<Recording> list_kitti(Recording recording, const fs::path& left_folder, const fs::path& right_folder,
                             const fs::path& times_file, LineParser parse, const char* expected) {
  const auto times = read_times(times_file, parse, expected);
  if (!times) return times.error();
  auto left = list_images(left_folder, times.value(), times_file);
  if (!left) return left.error();
  auto right = list_images(right_folder, times.value(), times_file);
  if (!right) return right.error();
  recording.left = std::move(left.value());
  recording.right = std::move(right.value());
  recording.listed_in = times_file.filename().string();
  return recording;
}

// "KEY: numbers" per line.
struct KeyLine {
  int line = 0;
  std::vector<double> values;
};

Result<std::map<std::string, KeyLine>> read_key_lines(const fs::path& file) {
  const auto content = read_text(file);
  if (!content) return content.error();
  std::map<std::string, KeyLine> keys;
  std::istringstream in(content.value());
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    KeyLine entry{number, {}};
    std::istringstream rest(line.substr(colon + 1));
    for (double value = 0; rest >> value;) entry.values.push_back(value);
    keys[line.substr(0, colon)] = std::move(entry);
  }
  return keys;
}

// 3x4 projections of the rectified gray cameras: P = K [I | t], t = -baseline of the camera from camera 0.
Result<LoadedCalibration> read_projections(const fs::path& file, const std::string& left_key,
                                           const std::string& right_key, const std::string& size_key) {
  auto keys = read_key_lines(file);
  if (!keys) return keys.error();
  LoadedCalibration out;
  StereoCalibration& c = out.calibration;
  double shift_m[2] = {};
  std::string place;
  for (int k = 0; k < 2; ++k) {
    const std::string& key = k == 0 ? left_key : right_key;
    const KeyLine& P = keys.value()[key];
    place = file.string() + (P.line > 0 ? ":" + std::to_string(P.line) : "");
    if (P.values.size() != 12)
      return Error{ErrorCode::bad_calibration, place,
                   P.line == 0 ? "'" + key + "' is missing"
                               : "'" + key + "' has " + std::to_string(P.values.size()) + " numbers instead of 12",
                   "use the calibration file that belongs to this recording"};
    CameraIntrinsics& camera = k == 0 ? c.left : c.right;
    camera.fx_px = P.values[0];
    camera.fy_px = P.values[5];
    camera.cx_px = P.values[2];
    camera.cy_px = P.values[6];
    shift_m[k] = P.values[3] / P.values[0];
    const std::vector<double>& size = keys.value()[size_key].values;
    if (size.size() == 2) {
      camera.width = static_cast<int>(size[0]);
      camera.height = static_cast<int>(size[1]);
    }
  }
  c.T_right_left.translation() = Eigen::Vector3d(shift_m[1] - shift_m[0], 0, 0);
  c.rectified = true;
  out.origin = "KITTI " + left_key + ", " + right_key + " of " + file.string();
  out.assumptions = {"images are rectified", "baseline from the fourth column of " + right_key};
  if (auto checked = check_calibration(c, place); !checked) return checked.error();
  return out;
}

}  // namespace

bool is_kitti_odometry(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path / "image_0", ignored);
}

Result<Recording> list_kitti_odometry(const fs::path& path) {
  const fs::path calib = path / "calib.txt";
  return list_kitti(
      {"KITTI odometry", path, {}, {}, {}, {}, [calib] { return read_projections(calib, "P0", "P1", ""); }},
      path / "image_0", path / "image_1", path / "times.txt", parse_seconds, "seconds, as in 1.037000e-01");
}

bool is_kitti_raw(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path / "image_00" / "data", ignored);
}

Result<Recording> list_kitti_raw(const fs::path& path) {
  std::error_code ignored;
  fs::path calib = path / "calib_cam_to_cam.txt";
  const fs::path above = fs::absolute(path / "..", ignored).lexically_normal() / "calib_cam_to_cam.txt";
  if (!fs::exists(calib, ignored) && fs::exists(above, ignored)) calib = above;
  return list_kitti({"KITTI raw",
                     path,
                     {},
                     {},
                     {"times of the left camera are used, taken as UTC"},
                     {},
                     [calib] { return read_projections(calib, "P_rect_00", "P_rect_01", "S_rect_00"); }},
                    path / "image_00" / "data", path / "image_01" / "data", path / "image_00" / "timestamps.txt",
                    parse_date_time, "2011-09-26 13:04:32.351950336");
}

Result<LoadedCalibration> read_kitti_calibration(const fs::path& file) {
  const auto keys = read_key_lines(file);
  if (!keys) return keys.error();
  if (keys.value().contains("P_rect_00")) return read_projections(file, "P_rect_00", "P_rect_01", "S_rect_00");
  return read_projections(file, "P0", "P1", "");
}

}  // namespace pelorus
