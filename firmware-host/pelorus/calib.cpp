#include "firmware-host/pelorus/calib.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rectifier.h"
#include "drivers/replay/dataset.h"
#include "drivers/replay/image_file.h"
#include "firmware-host/pelorus/picture_file.h"
#include "firmware-host/runtime/calibration.h"
#include "firmware-host/runtime/calibration_writer.h"
#include "firmware-host/runtime/row_check.h"
#include "firmware-host/runtime/side_check.h"

namespace pelorus {
namespace {

struct CheckArguments {
  std::string input;
  std::string calibration;
  std::string image_left;
  std::string image_right;
  std::string picture;
  std::size_t pair = 0;
};

struct ConvertArguments {
  std::string input;
  std::string out;
  std::string format;
  bool overwrite = false;
};

struct NamedFormat {
  const char* word;  // of --to
  CalibrationFormat format;
};

constexpr std::array<NamedFormat, 4> kFormats{{{"euroc", CalibrationFormat::euroc},
                                               {"kalibr", CalibrationFormat::kalibr},
                                               {"opencv", CalibrationFormat::opencv},
                                               {"ros", CalibrationFormat::ros}}};

constexpr double degrees(double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; }

const char* lens_text(LensKind lens) {
  switch (lens) {
    case LensKind::none:
      return "no distortion";
    case LensKind::radtan:
      return "radtan";
    case LensKind::rational:
      return "rational";
    case LensKind::equidistant:
      return "equidistant";
  }
  return "";
}

// Fills a size that the calibration leaves open from the image.
void complete_size(StereoCalibration& c, const Image& left) {
  for (CameraIntrinsics* camera : {&c.left, &c.right}) {
    if (camera->width != 0) continue;
    camera->width = left.width();
    camera->height = left.height();
  }
}

Result<std::optional<SourcePair>> read_images(const CheckArguments& arguments, LoadedCalibration& loaded) {
  if (arguments.image_left.empty()) return std::optional<SourcePair>();
  SourcePair pair;
  ImageFile file;
  if (auto left = file.read(arguments.image_left, pair.left); !left) return left.error();
  if (auto right = file.read(arguments.image_right, pair.right); !right) return right.error();
  complete_size(loaded.calibration, pair.left);
  const std::array<std::pair<const Image*, const CameraIntrinsics*>, 2> sides{
      {{&pair.left, &loaded.calibration.left}, {&pair.right, &loaded.calibration.right}}};
  for (const auto& [image, camera] : sides) {
    if (image->width() == camera->width && image->height() == camera->height) continue;
    return Error{ErrorCode::bad_input, image == &pair.left ? arguments.image_left : arguments.image_right,
                 "is " + std::to_string(image->width()) + "x" + std::to_string(image->height()) +
                     ", the calibration is for " + std::to_string(camera->width) + "x" + std::to_string(camera->height),
                 "use images of the size that was calibrated"};
  }
  return std::optional<SourcePair>(std::move(pair));
}

Result<std::optional<SourcePair>> read_recorded(const CheckArguments& arguments, LoadedCalibration& loaded) {
  auto source = open_dataset(arguments.input, loaded);
  if (!source) return source.error();
  const std::size_t count = source.value()->pair_count();
  if (arguments.pair >= count)
    return Error{ErrorCode::bad_usage, "--pair " + std::to_string(arguments.pair),
                 "the recording has " + pairs_text(count), "count from 0"};
  SourcePair pair;
  // Damaged pairs on the way do not matter, the one asked for does.
  for (std::size_t i = 0; i <= arguments.pair; ++i)
    if (auto more = source.value()->next(pair); !more && i == arguments.pair) return more.error();
  loaded.calibration = source.value()->calibration();
  return std::optional<SourcePair>(std::move(pair));
}

void print_camera(const char* side, const CameraIntrinsics& c) {
  std::printf("%-10s  %dx%d, f %.3f %.3f px, center %.3f %.3f px, %s\n", side, c.width, c.height, c.fx_px, c.fy_px,
              c.cx_px, c.cy_px, lens_text(c.lens));
}

void print_rig(const Rectifier& rectifier) {
  const StereoRig& rig = rectifier.rig();
  std::printf("rectified   %dx%d, f %.3f px, center %.3f %.3f px, baseline %.5f m%s\n", rig.width, rig.height, rig.f_px,
              rig.cx_px, rig.cy_px, rig.baseline_m,
              rectifier.is_pass_through() ? " (images pass through unchanged)" : "");
  std::printf("view        %.1f x %.1f deg\n", degrees(2 * std::atan(0.5 * rig.width / rig.f_px)),
              degrees(2 * std::atan(0.5 * rig.height / rig.f_px)));
  constexpr double kDisparitySigma_px = 0.25;
  std::printf("depth error %.1f mm at 1 m, %.1f mm at 3 m, %.0f mm at 10 m (disparity good to %.2f px)\n",
              1e3 * rig.depth_sigma_m(1, kDisparitySigma_px), 1e3 * rig.depth_sigma_m(3, kDisparitySigma_px),
              1e3 * rig.depth_sigma_m(10, kDisparitySigma_px), kDisparitySigma_px);
}

// What is legal and yet most likely not meant.
std::vector<std::string> calibration_warnings(const StereoCalibration& c, const Rectifier& rectifier) {
  std::vector<std::string> out;
  const double turn_deg = degrees(rotation_angle_rad(c.T_right_left.linear()));
  if (turn_deg > 10) out.push_back("the cameras are turned against each other by more than 10 deg: check R");
  if (std::abs(c.left.fx_px / c.right.fx_px - 1) > 0.03)
    out.push_back("the cameras' focal lengths differ by more than 3 %: is this one pair?");
  if (rectifier.rig().f_px > 1.5 * c.left.fx_px)
    out.push_back("rectification keeps less than two thirds of the view: check distortion and rotation");
  if (c.left.lens == LensKind::none && !rectifier.is_pass_through())
    out.push_back("no lens distortion, but the images are not rectified either");
  return out;
}

cv::Mat draw_pair(const Image& left, const Image& right) {
  constexpr int kLines = 20;
  const int w = left.width();
  const int h = left.height();
  cv::Mat gray(h, 2 * w, CV_8U);
  for (int v = 0; v < h; ++v) {
    std::copy_n(left.row(v), w, gray.ptr(v));
    std::copy_n(right.row(v), w, gray.ptr(v) + w);
  }
  cv::Mat picture;
  cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
  for (int i = 1; i < kLines; ++i) {
    const cv::Scalar color = i % 2 == 0 ? cv::Scalar(80, 220, 80) : cv::Scalar(60, 160, 255);
    cv::line(picture, {0, i * h / kLines}, {2 * w - 1, i * h / kLines}, color);
  }
  return picture;
}

Result<> check_pair(const SourcePair& pair, const Rectifier& rectifier, const std::string& picture,
                    std::vector<std::string>& warnings) {
  Image left;
  Image right;
  rectifier.apply_left(pair.left.view(), left);
  rectifier.apply_right(pair.right.view(), right);
  const RowAgreement rows = measure_rows(left.view(), right.view());
  std::printf("rows        offset %+.2f px, half within %.2f px (%d patches of this pair)\n", rows.median_px,
              rows.spread_px, rows.patches);
  if (sides_of(match_sides(pair, rectifier)) == Sides::exchanged) {
    warnings.push_back("the left and right pictures are exchanged: points match only when they change places");
  } else if (rows.patches < 20) {
    warnings.push_back("too little in common to judge the rows: try another pair");
  } else if (std::abs(rows.median_px) > 0.5 || rows.spread_px > 0.7) {
    warnings.push_back("the rows of the rectified pair do not agree: this calibration does not fit these images");
  }
  if (picture.empty()) return Ok{};
  if (auto written = write_picture(picture, draw_pair(left, right)); !written) return written;
  std::printf("picture     %s\n", picture.c_str());
  return Ok{};
}

Result<int> run_check(const CheckArguments& arguments) {
  if (!arguments.picture.empty()) {
    if (auto usable = check_picture_name(arguments.picture); !usable) return usable.error();
  }
  auto read = load_calibration(arguments.calibration.empty() ? arguments.input : arguments.calibration);
  if (!read) return read.error();
  LoadedCalibration loaded = std::move(read.value());
  std::error_code ignored;
  const bool recorded = arguments.image_left.empty() && std::filesystem::is_directory(arguments.input, ignored) &&
                        list_recording(arguments.input).ok();
  const auto pair = recorded ? read_recorded(arguments, loaded) : read_images(arguments, loaded);
  if (!pair) return pair.error();
  if (!pair.value() && !arguments.picture.empty())
    return Error{ErrorCode::bad_usage, "--out", "a picture needs a recorded pair",
                 "pass a data set, or --image-left and --image-right"};
  const StereoCalibration& c = loaded.calibration;
  std::printf("calibration %s\n", loaded.origin.c_str());
  for (const std::string& assumption : loaded.assumptions) std::printf("assumed     %s\n", assumption.c_str());
  print_camera("left", c.left);
  print_camera("right", c.right);
  const Eigen::Vector3d place = c.T_right_left.inverse().translation();
  std::printf("right camera at %.5f %.5f %.5f m from the left one, turned by %.3f deg\n", place.x(), place.y(),
              place.z(), degrees(rotation_angle_rad(c.T_right_left.linear())));
  const auto rectifier = Rectifier::create(c, loaded.origin);
  if (!rectifier) return rectifier.error();
  print_rig(rectifier.value());
  std::vector<std::string> warnings = calibration_warnings(c, rectifier.value());
  if (pair.value()) {
    if (auto checked = check_pair(*pair.value(), rectifier.value(), arguments.picture, warnings); !checked)
      return checked.error();
  }
  for (const std::string& warning : warnings) std::printf("warning     %s\n", warning.c_str());
  return 0;
}

Result<int> run_convert(const ConvertArguments& arguments) {
  auto loaded = load_calibration(arguments.input);
  if (!loaded) return loaded.error();
  // Where the calibration leaves the size open (KITTI odometry), the recording's images tell it.
  std::error_code ignored;
  if (loaded.value().calibration.left.width == 0 && std::filesystem::is_directory(arguments.input, ignored)) {
    auto source = open_dataset(arguments.input, loaded.value());
    if (!source) return source.error();
    loaded.value().calibration = source.value()->calibration();
  }
  // The parser lets no other word through.
  const auto* named = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const NamedFormat& known) { return arguments.format == known.word; });
  if (auto written = write_calibration(loaded.value().calibration, named->format, arguments.out, arguments.overwrite);
      !written)
    return written.error();
  std::printf("calibration %s\n", loaded.value().origin.c_str());
  for (const std::string& assumption : loaded.value().assumptions) std::printf("assumed     %s\n", assumption.c_str());
  std::printf("written     %s\n", arguments.out.c_str());
  return 0;
}

}  // namespace

Verb add_calib(CLI::App& app) {
  CLI::App* parser = app.add_subcommand("calib", "Check a stereo calibration, or write it in another format");
  parser->require_subcommand(1);
  auto check_arguments = std::make_shared<CheckArguments>();
  CLI::App* check = parser->add_subcommand("check", "Say what a calibration amounts to and draw a rectified pair");
  check
      ->add_option("INPUT", check_arguments->input,
                   "OpenCV, Kalibr, ROS, EuRoC or KITTI calibration, or a data-set folder")
      ->required();
  check->add_option("--calib", check_arguments->calibration, "This calibration with the images of data set INPUT");
  CLI::Option* left = check->add_option("--image-left", check_arguments->image_left, "Raw image of the left camera");
  CLI::Option* right =
      check->add_option("--image-right", check_arguments->image_right, "Raw image of the right camera");
  left->needs(right);
  right->needs(left);
  check->add_option("--pair", check_arguments->pair, "Which pair of the data set, counted from 0")
      ->check(whole_from_zero());
  check->add_option("--out", check_arguments->picture, "Picture (PNG) of the rectified pair with horizontal lines");
  check->footer("Exit codes: 0 checked (warnings included), 2 usage, 3 bad images, 4 calibration, 6 input/output.");

  auto convert_arguments = std::make_shared<ConvertArguments>();
  CLI::App* convert = parser->add_subcommand("convert", "Write a calibration in another format");
  convert->add_option("INPUT", convert_arguments->input, "Any calibration or data set that check reads")->required();
  std::vector<std::string> formats;
  for (const NamedFormat& known : kFormats) formats.emplace_back(known.word);
  convert->add_option("--to", convert_arguments->format, "opencv, kalibr (files), ros, euroc (folders)")
      ->required()
      ->check(one_of(formats));
  convert->add_option("--out", convert_arguments->out, "File or folder to write")->required();
  convert->add_flag("--overwrite", convert_arguments->overwrite, "Replace what is there under this name");
  convert->footer("Exit codes: 0 written, 2 usage, 4 calibration, 6 input/output.");
  return {parser, [check, check_arguments, convert_arguments] {
            return check->parsed() ? run_check(*check_arguments) : run_convert(*convert_arguments);
          }};
}

}  // namespace pelorus
