#include "firmware-host/runtime/calibration.h"

#include <filesystem>

#include "drivers/replay/dataset.h"
#include "drivers/replay/euroc.h"
#include "drivers/replay/kitti.h"
#include "firmware-host/runtime/calibration_formats.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

Error refuse(const std::string& place, std::string detail, std::string cure) {
  return Error{ErrorCode::bad_calibration, place, std::move(detail), std::move(cure)};
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// First of the names that is a file of the folder; empty when none is.
fs::path first_file(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (is_file(folder / name)) return folder / name;
  return {};
}

// The other camera's file: "left" and "right" exchanged in the name.
fs::path partner_of(const fs::path& file, bool& is_left) {
  std::string name = file.filename().string();
  const std::size_t left = name.rfind("left");
  const std::size_t right = name.rfind("right");
  is_left = left != std::string::npos;
  if (is_left) return file.parent_path() / name.replace(left, 4, "right");
  if (right != std::string::npos) return file.parent_path() / name.replace(right, 5, "left");
  return {};
}

Result<LoadedCalibration> load_folder(const fs::path& folder) {
  const fs::path left = first_file(folder, {"left.yaml", "left.yml"});
  const fs::path right = first_file(folder, {"right.yaml", "right.yml"});
  if (!left.empty() && !right.empty()) return read_ros_pair(left, right);
  const fs::path intrinsics = first_file(folder, {"intrinsics.yml", "intrinsics.yaml", "intrinsics.xml"});
  const fs::path extrinsics = first_file(folder, {"extrinsics.yml", "extrinsics.yaml", "extrinsics.xml"});
  if (!intrinsics.empty() && !extrinsics.empty()) return read_opencv({intrinsics, extrinsics});
  // EuRoC's calibration without its images is a calibration too.
  if (const fs::path mav0 = find_euroc(folder); !mav0.empty()) return read_euroc_calibration(mav0);
  const auto recording = list_recording(folder);
  if (recording) return recording.value().read_calibration();
  return refuse(folder.string(), "holds no calibration",
                "expected left.yaml and right.yaml (ROS), intrinsics.yml and extrinsics.yml (OpenCV) or a data set");
}

Result<LoadedCalibration> load_ros_half(const fs::path& file) {
  bool is_left = false;
  const fs::path partner = partner_of(file, is_left);
  if (!is_file(partner))
    return refuse(file.string(), "is the ROS camera_info of one camera and the other one is not beside it",
                  "pass the folder with left.yaml and right.yaml, or both files as LEFT,RIGHT");
  return is_left ? read_ros_pair(file, partner) : read_ros_pair(partner, file);
}

Result<LoadedCalibration> load_file(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".xml") return read_opencv({file});
  if (extension == ".txt") return read_kitti_calibration(file);
  const auto loaded = read_calibration_yaml(file);
  if (!loaded) return loaded.error();
  const CalibrationYaml& yaml = loaded.value();
  if (child(yaml.root, "cam0").IsDefined()) return read_kalibr(yaml);
  // camX/sensor.yaml stands two levels below the folder that holds both cameras.
  if (child(yaml.root, "T_BS").IsDefined())
    return read_euroc_calibration(fs::absolute(file).parent_path().parent_path());
  if (child(yaml.root, "projection_matrix").IsDefined()) return load_ros_half(file);
  if (looks_like_opencv(yaml)) return read_opencv({file});
  return refuse(file.string(), "is no stereo calibration of a known format",
                "known: OpenCV (M1, D1, M2, D2, R, T), Kalibr camchain (cam0, cam1), ROS camera_info pair, EuRoC "
                "sensor.yaml, KITTI calib.txt");
}

Result<LoadedCalibration> load_unchecked(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return load_folder(path);
  if (is_file(path)) return load_file(path);
  if (const std::size_t comma = path.find(','); comma != std::string::npos)
    return read_ros_pair(path.substr(0, comma), path.substr(comma + 1));
  return Error{ErrorCode::io, path, "does not exist", "check the path of the calibration"};
}

}  // namespace

Result<LoadedCalibration> load_calibration(const std::string& path) {
  auto loaded = load_unchecked(path);
  if (!loaded) return loaded;
  if (auto checked = check_calibration(loaded.value().calibration, path); !checked) return checked.error();
  return loaded;
}

}  // namespace pelorus
