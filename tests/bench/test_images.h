#pragma once
// Images for the benchmarks: the data sets' where present (PELORUS_DATA_DIR), else a rendered texture.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/base/image.h"

namespace pelorus::bench {

inline std::filesystem::path data_dir() {
  const char* set = std::getenv("PELORUS_DATA_DIR");
  return set != nullptr ? std::filesystem::path(set) : std::filesystem::path(PELORUS_SOURCE_DIR) / "../shared/data";
}

inline cv::Mat rendered(int width, int height) {
  cv::Mat image(height, width, CV_8U, cv::Scalar(128));
  cv::RNG rng(1);
  for (int cell = 4; cell <= 128; cell *= 2) {
    cv::Mat noise(height / cell + 2, width / cell + 2, CV_8U);
    cv::Mat large;
    rng.fill(noise, cv::RNG::UNIFORM, 0, 255);
    cv::resize(noise, large, image.size(), 0, 0, cv::INTER_CUBIC);
    cv::addWeighted(image, 0.7, large, 0.3, 0, image);
  }
  return image;
}

// The file, or a rendered texture of the size; `where` says which.
inline cv::Mat load_or_render(const std::string& file, int width, int height, std::string& where) {
  cv::Mat image = cv::imread((data_dir() / file).string(), cv::IMREAD_GRAYSCALE);
  where = image.empty() ? "rendered" : file;
  return image.empty() ? rendered(width, height) : image;
}

inline ImageView view(const cv::Mat& m) { return {m.data, m.cols, m.rows, static_cast<std::ptrdiff_t>(m.step)}; }

}  // namespace pelorus::bench
