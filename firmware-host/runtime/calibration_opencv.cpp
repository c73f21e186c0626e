// OpenCV stereo calibrations: YAML (read with line numbers) and XML, with the names that programs use for them.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>

#include "firmware-host/runtime/calibration_formats.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

struct Entry {
  std::vector<double> values;
  std::string text;
  std::string place;
};
// By name in lower case without punctuation: camera_matrix_left, cameraMatrixLeft and LEFT.K need no list each.
using Entries = std::map<std::string, Entry>;

Error refuse(const std::string& place, std::string detail, std::string cure) {
  return Error{ErrorCode::bad_calibration, place, std::move(detail), std::move(cure)};
}

std::string plain_name(const std::string& name) {
  std::string out;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

struct Names {
  const char* meaning;
  std::vector<const char*> plain;
};
const Names kMatrix[2] = {{"left camera matrix (M1, K1, cameraMatrix1, cameraMatrixL, camera_matrix_left, LEFT.K)",
                           {"m1", "cameramatrix1", "cameramatrixl", "cameramatrixleft", "leftcameramatrix", "leftk",
                            "kleft", "kl", "mleft", "ml", "intrinsicmatrixleft", "k1"}},
                          {"right camera matrix (M2, K2, cameraMatrix2, cameraMatrixR, camera_matrix_right, RIGHT.K)",
                           {"m2", "cameramatrix2", "cameramatrixr", "cameramatrixright", "rightcameramatrix", "rightk",
                            "kright", "kr", "mright", "mr", "intrinsicmatrixright", "k2"}}};
const Names kDistortion[2] = {
    {"left distortion (D1, distCoeffs1, distCoeffsL, dist_coeffs_left, LEFT.D)",
     {"d1", "distcoeffs1", "distcoeffsl", "distcoeffsleft", "leftdistcoeffs", "leftd", "dleft", "dl",
      "distortioncoefficientsleft", "leftdistortioncoefficients", "distortionleft"}},
    {"right distortion (D2, distCoeffs2, distCoeffsR, dist_coeffs_right, RIGHT.D)",
     {"d2", "distcoeffs2", "distcoeffsr", "distcoeffsright", "rightdistcoeffs", "rightd", "dright", "dr",
      "distortioncoefficientsright", "rightdistortioncoefficients", "distortionright"}}};
const Names kRotation = {"rotation from left to right (R)", {"r", "rotation", "rotationmatrix", "stereor", "rmat"}};
const Names kTranslation = {"translation from left to right (T)",
                            {"t", "translation", "translationvector", "stereot", "tvec"}};

const Entry* find(const Entries& entries, const Names& names) {
  for (const char* name : names.plain)
    if (const auto found = entries.find(name); found != entries.end()) return &found->second;
  return nullptr;
}

Result<> add_yaml(const fs::path& file, Entries& entries) {
  const auto loaded = read_calibration_yaml(file);
  if (!loaded) return loaded.error();
  const CalibrationYaml& yaml = loaded.value();
  for (const auto& pair : yaml.root) {
    Entry entry{{}, pair.second.IsScalar() ? pair.second.Scalar() : "", yaml.place(pair.first)};
    auto values = numbers(yaml, yaml.root, pair.first.Scalar(), 0, 1000);
    if (values) entry.values = std::move(values.value());
    entries[plain_name(pair.first.Scalar())] = std::move(entry);
  }
  return Ok{};
}

Result<> add_xml(const fs::path& file, Entries& entries) {
  try {
    cv::FileStorage storage(file.string(), cv::FileStorage::READ);
    if (!storage.isOpened()) return refuse(file.string(), "cannot be read", "check that it is an OpenCV XML file");
    const cv::FileNode root = storage.root();
    for (auto it = root.begin(); it != root.end(); ++it) {
      const cv::FileNode node = *it;
      Entry entry{{}, node.isString() ? node.string() : "", file.string()};
      if (node.isMap()) {
        cv::Mat matrix;
        node.mat().convertTo(matrix, CV_64F);
        for (int i = 0; i < matrix.rows; ++i)
          for (int k = 0; k < matrix.cols; ++k) entry.values.push_back(matrix.at<double>(i, k));
      } else if (node.isReal() || node.isInt()) {
        entry.values.push_back(node.real());
      } else if (node.isSeq()) {
        for (const cv::FileNode number : node)
          if (number.isReal() || number.isInt()) entry.values.push_back(number.real());
      }
      entries[plain_name(node.name())] = std::move(entry);
    }
  } catch (const cv::Exception& e) {
    return refuse(file.string(), "not a valid OpenCV file: " + e.err, "write it again with cv::FileStorage");
  }
  return Ok{};
}

Result<const Entry*> require(const Entries& entries, const Names& names, std::size_t count_min, std::size_t count_max,
                             const std::string& file) {
  const Entry* entry = find(entries, names);
  if (entry == nullptr) return refuse(file, std::string(names.meaning) + " is missing", "add it to the file");
  if (entry->values.size() >= count_min && entry->values.size() <= count_max) return entry;
  return refuse(entry->place,
                std::string(names.meaning) + " has " + std::to_string(entry->values.size()) + " numbers instead of " +
                    std::to_string(count_max),
                "correct the matrix");
}

void read_size(const Entries& entries, CameraIntrinsics& camera) {
  if (const Entry* size = find(entries, {"", {"imagesize", "imgsize", "size"}}); size && size->values.size() == 2) {
    camera.width = static_cast<int>(size->values[0]);
    camera.height = static_cast<int>(size->values[1]);
    return;
  }
  const Entry* width = find(entries, {"", {"imagewidth", "width", "camerawidth", "leftwidth"}});
  const Entry* height = find(entries, {"", {"imageheight", "height", "cameraheight", "leftheight"}});
  if (width && height && width->values.size() == 1 && height->values.size() == 1) {
    camera.width = static_cast<int>(width->values[0]);
    camera.height = static_cast<int>(height->values[0]);
  }
}

Result<> read_camera(const Entries& entries, int side, const std::string& file, CameraIntrinsics& camera,
                     std::vector<std::string>& assumptions) {
  const auto matrix = require(entries, kMatrix[side], 9, 9, file);
  if (!matrix) return matrix.error();
  const std::vector<double>& K = matrix.value()->values;
  if (K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1)
    return refuse(matrix.value()->place, "is no camera matrix: expected fx 0 cx 0 fy cy 0 0 1",
                  "check its nine numbers");
  camera.fx_px = K[0];
  camera.fy_px = K[4];
  camera.cx_px = K[2];
  camera.cy_px = K[5];
  if (K[1] != 0) assumptions.push_back("the skew of " + std::to_string(K[1]) + " px is ignored");
  read_size(entries, camera);
  const auto distortion = require(entries, kDistortion[side], 1, 14, file);
  if (!distortion) return distortion.error();
  const std::vector<double>& k = distortion.value()->values;
  const Entry* named = find(entries, {"", {"distortionmodel", "lensmodel", "lens"}});
  std::string model = k.size() > 5 ? "rational" : "radtan";
  if (named != nullptr && !named->text.empty()) {
    model = named->text;
  } else if (side == 0) {
    assumptions.push_back(std::to_string(k.size()) + " distortion coefficients are taken as " + model +
                          (k.size() == 4 ? " (for a fisheye add 'distortion_model: equidistant')" : ""));
  }
  return set_lens(camera, model, k, distortion.value()->place);
}

}  // namespace

bool looks_like_opencv(const CalibrationYaml& yaml) {
  Entries names;
  for (const auto& pair : yaml.root) names[plain_name(pair.first.Scalar())] = {};
  return find(names, kMatrix[0]) != nullptr || find(names, kMatrix[1]) != nullptr ||
         find(names, kDistortion[0]) != nullptr;
}

Result<LoadedCalibration> read_opencv(const std::vector<fs::path>& files) {
  Entries entries;
  std::string file_names;
  for (const fs::path& file : files) {
    if (auto added = file.extension() == ".xml" ? add_xml(file, entries) : add_yaml(file, entries); !added)
      return added.error();
    file_names += (file_names.empty() ? "" : ", ") + file.string();
  }
  LoadedCalibration out;
  out.origin = "OpenCV " + file_names;
  out.assumptions.push_back("R and T map left camera coordinates to the right camera, T in metres");
  StereoCalibration& c = out.calibration;
  for (int side = 0; side < 2; ++side) {
    CameraIntrinsics& camera = side == 0 ? c.left : c.right;
    if (auto read = read_camera(entries, side, file_names, camera, out.assumptions); !read) return read.error();
  }
  if (c.left.width == 0) out.assumptions.push_back("the image size is not in the file; it is taken from the images");
  const auto translation = require(entries, kTranslation, 3, 3, file_names);
  if (!translation) return translation.error();
  const auto rotation = require(entries, kRotation, 3, 9, file_names);
  if (!rotation) return rotation.error();
  const std::vector<double>& t = translation.value()->values;
  std::vector<double> r = rotation.value()->values;
  if (r.size() == 3) {
    out.assumptions.push_back("R is given as a rotation vector");
    const Eigen::Matrix3d R = so3_exp({r[0], r[1], r[2]});
    r = {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
  }
  if (r.size() != 9)
    return refuse(rotation.value()->place, "R has " + std::to_string(r.size()) + " numbers instead of 9", "correct it");
  const auto T = rigid_from_rows({r[0], r[1], r[2], t[0], r[3], r[4], r[5], t[1], r[6], r[7], r[8], t[2], 0, 0, 0, 1},
                                 rotation.value()->place);
  if (!T) return T.error();
  c.T_right_left = T.value();
  if (auto checked = check_calibration(c, translation.value()->place); !checked) return checked.error();
  return out;
}

}  // namespace pelorus
