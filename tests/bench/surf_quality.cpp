// Repeatability and matching score of our SURF beside dlib's at the same number of points, on the Oxford "boat"
// images (zoom and rotation, known homographies) and on rendered warps of it.
//   surf_quality [points]
// dlib finds one blob several times, in filter sizes that two octaves share or nearly so, and every twin counts as a
// point found again. Hence each detector is listed both ways: "distinct" with one point a blob (ours by default, dlib's
// points thinned by the same rule and filled up to the same number), "twins kept" with all of them (ours with five
// filter sizes an octave, so that as many overlap).

#include <dlib/image_keypoint.h>
#include <dlib/image_transforms.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/frontend/surf.h"
#include "core/frontend/surf_match.h"

namespace {

using namespace pelorus;

struct Features {
  std::vector<SurfPoint> points;
  std::vector<SurfDescriptor> descriptors;
};

Features ours(const cv::Mat& image, int count, bool upright, bool distinct) {
  SurfConfig config;
  config.threshold = 1.0F;
  config.max_points = count;
  config.upright = upright;
  config.distinct = distinct;
  if (!distinct) config.intervals = 5;
  Surf surf(config, image.cols, image.rows);
  const auto points = surf.detect({image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)});
  Features f{{points.begin(), points.end()}, std::vector<SurfDescriptor>(points.size())};
  surf.describe(points, f.descriptors);
  return f;
}

bool are_twins(const SurfPoint& a, const SurfPoint& b) {
  const float smaller = std::min(a.scale, b.scale);
  return std::hypot(a.u_px - b.u_px, a.v_px - b.v_px) < smaller && std::max(a.scale, b.scale) < 1.23F * smaller;
}

// The strongest `count`, by score: what dlib::get_surf_points does, which orders nothing and always orients, step by
// step.
Features dlibs(const cv::Mat& image, std::size_t count, bool upright, bool distinct) {
  dlib::array2d<unsigned char> copy(image.rows, image.cols);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) copy[v][u] = image.at<unsigned char>(v, u);
  }
  dlib::integral_image sums;
  sums.load(copy);
  dlib::hessian_pyramid pyramid;
  pyramid.build_pyramid(sums, 4, 6, 2);
  std::vector<dlib::interest_point> found;
  dlib::get_interest_points(pyramid, 0.05, found);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  const dlib::rectangle inside = dlib::get_rect(sums);
  Features f;
  for (const dlib::interest_point& p : found) {
    if (f.points.size() == count) break;
    const auto side = static_cast<unsigned long>(32 * p.scale);
    if (!inside.contains(dlib::centered_rect(p.center, side, side))) continue;
    SurfPoint point;
    point.u_px = static_cast<float>(p.center.x());
    point.v_px = static_cast<float>(p.center.y());
    point.scale = static_cast<float>(p.scale);
    point.laplacian = p.laplacian > 0 ? 1 : -1;
    const auto twin = [&](const SurfPoint& q) { return are_twins(point, q); };
    if (distinct && std::any_of(f.points.begin(), f.points.end(), twin)) continue;
    const double angle = upright ? 0.0 : dlib::compute_dominant_angle(sums, p.center, p.scale);
    dlib::matrix<double, 64, 1> described;
    dlib::compute_surf_descriptor(sums, p.center, p.scale, angle, described);
    SurfDescriptor d;
    for (int k = 0; k < 64; ++k) d[static_cast<std::size_t>(k)] = static_cast<float>(described(k));
    f.points.push_back(point);
    f.descriptors.push_back(d);
  }
  return f;
}

struct Placed {
  Eigen::Vector2d p;
  double zoom;
};

Placed map(const Eigen::Matrix3d& H, const SurfPoint& s) {
  const Eigen::Vector3d q = H * Eigen::Vector3d(s.u_px, s.v_px, 1);
  const double det = H.determinant() / std::pow(q.z(), 3);
  return {q.hnormalized(), std::sqrt(std::abs(det))};
}

struct Score {
  double repeatability = 0;  // share of the points both images show that were found again
  double correct = 0;        // correct mutual matches per such point
  double precision = 0;      // of the matches
  double place_px = 0;       // median error of correct matches
};

bool agrees(const Placed& where, const SurfPoint& a, const SurfPoint& b) {
  const double tolerance_px = 2.5;
  const double distance = (where.p - Eigen::Vector2d(b.u_px, b.v_px)).norm();
  return distance < tolerance_px && std::abs(std::log2(where.zoom * static_cast<double>(a.scale / b.scale))) < 0.6;
}

Score score(const Features& a, const Features& b, const Eigen::Matrix3d& H, const cv::Size& size) {
  const auto inside = [&](const Eigen::Vector2d& p) {
    return p.x() >= 0 && p.y() >= 0 && p.x() < size.width && p.y() < size.height;
  };
  const Eigen::Matrix3d H_back = H.inverse();
  double common_b = 0;
  for (const SurfPoint& p : b.points) common_b += inside(map(H_back, p).p);
  double common_a = 0;
  double found = 0;
  for (const SurfPoint& p : a.points) {
    const Placed where = map(H, p);
    if (!inside(where.p)) continue;
    ++common_a;
    for (const SurfPoint& q : b.points) {
      if (!agrees(where, p, q)) continue;
      ++found;
      break;
    }
  }
  const double common = std::max(1.0, std::min(common_a, common_b));
  SurfMatcher matcher({});
  const auto matches = matcher.match(a.points, a.descriptors, b.points, b.descriptors, kAnywhere_px);
  std::vector<double> errors;
  for (const SurfMatch& m : matches) {
    const SurfPoint& p = a.points[static_cast<std::size_t>(m.first)];
    const SurfPoint& q = b.points[static_cast<std::size_t>(m.second)];
    const Placed where = map(H, p);
    if (agrees(where, p, q)) errors.push_back((where.p - Eigen::Vector2d(q.u_px, q.v_px)).norm());
  }
  std::sort(errors.begin(), errors.end());
  const auto correct = static_cast<double>(errors.size());
  return {found / common, correct / common, correct / std::max<double>(1.0, static_cast<double>(matches.size())),
          errors.empty() ? 0 : errors[errors.size() / 2]};
}

void compare(const std::string& name, const cv::Mat& a, const cv::Mat& b, const Eigen::Matrix3d& H, int count) {
  const auto print = [&](const char* who, const Features& fa, const Features& fb) {
    const Score s = score(fa, fb, H, b.size());
    std::printf("%-12s %-17s %5zu %5zu  repeatability %5.1f%%  correct %5.1f%%  precision %5.1f%%  error %.2f px\n",
                name.c_str(), who, fa.points.size(), fb.points.size(), 100 * s.repeatability, 100 * s.correct,
                100 * s.precision, s.place_px);
  };
  const auto n = static_cast<std::size_t>(count);
  print("ours", ours(a, count, false, true), ours(b, count, false, true));
  print("dlib, distinct", dlibs(a, n, false, true), dlibs(b, n, false, true));
  print("ours, twins kept", ours(a, count, false, false), ours(b, count, false, false));
  print("dlib, twins kept", dlibs(a, n, false, false), dlibs(b, n, false, false));
  print("ours, upright", ours(a, count, true, true), ours(b, count, true, true));
  print("dlib, upright", dlibs(a, n, true, true), dlibs(b, n, true, true));
}

Eigen::Matrix3d similarity(double angle_deg, double zoom, double cu, double cv) {
  const double a = angle_deg * 3.14159265358979 / 180;
  Eigen::Matrix3d R;
  R << zoom * std::cos(a), -zoom * std::sin(a), cu, zoom * std::sin(a), zoom * std::cos(a), cv, 0, 0, 1;
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.block<2, 1>(0, 2) = Eigen::Vector2d(-cu, -cv);
  return R * T;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 1000;
  const char* root = std::getenv("PELORUS_DATA_DIR");
  const std::filesystem::path boat =
      (root ? std::filesystem::path(root) : std::filesystem::path(PELORUS_SOURCE_DIR) / "../shared/data") /
      "homography/boat";
  const cv::Mat first = cv::imread((boat / "img1.pgm").string(), cv::IMREAD_GRAYSCALE);
  if (first.empty()) {
    std::fprintf(stderr, "%s: no images; set PELORUS_DATA_DIR\n", boat.c_str());
    return 3;
  }
  for (int i = 2; i <= 6; ++i) {
    const std::string n = std::to_string(i);
    const cv::Mat other = cv::imread((boat / ("img" + n + ".pgm")).string(), cv::IMREAD_GRAYSCALE);
    Eigen::Matrix3d H;
    std::ifstream in(boat / ("H1to" + n + "p"));
    for (int k = 0; k < 9; ++k) in >> H(k / 3, k % 3);
    compare("boat 1-" + n, first, other, H, count);
  }
  const struct {
    const char* name;
    double angle, zoom;
  } kRendered[] = {{"shift 0.4", 0, 1}, {"rotation 5", 5, 1}, {"rotation 30", 30, 1}, {"zoom 0.8", 0, 0.8}};
  for (const auto& r : kRendered) {
    Eigen::Matrix3d H = similarity(r.angle, r.zoom, first.cols / 2.0, first.rows / 2.0);
    H(0, 2) += 0.4;
    H(1, 2) -= 0.3;
    const cv::Mat Hcv = (cv::Mat_<double>(3, 3) << H(0, 0), H(0, 1), H(0, 2), H(1, 0), H(1, 1), H(1, 2), 0, 0, 1);
    cv::Mat warped;
    cv::Mat noise(first.size(), CV_16S);
    cv::warpPerspective(first, warped, Hcv, first.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    cv::RNG rng(1);
    rng.fill(noise, cv::RNG::NORMAL, 0, 2);
    cv::Mat sum;
    warped.convertTo(sum, CV_16S);
    sum += noise;
    sum.convertTo(warped, CV_8U);
    compare(r.name, first, warped, H, count);
  }
  return 0;
}
