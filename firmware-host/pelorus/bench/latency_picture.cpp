#include "firmware-host/pelorus/bench/latency_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "firmware-host/pelorus/picture_file.h"

namespace pelorus {
namespace {

constexpr int kWidth = 900;
constexpr int kPanelHeight = 260;
constexpr int kLeft = 60;
constexpr int kRight = 20;
constexpr int kTop = 40;
constexpr int kBottom = 40;
constexpr int kBins = 80;

const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kGrid(220, 220, 220);
const cv::Scalar kBar(178, 114, 0);
const cv::Scalar kMark(0, 94, 213);

void write(cv::Mat& picture, const std::string& text, cv::Point at, double size = 0.45) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

// A round number that five of reach at least `span`.
double round_step(double span) {
  const double raw = std::max(span, 1e-9) / 5;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= raw) return factor * decade;
  }
  return 10 * decade;
}

struct Axis {
  double least = 0;
  double step = 1;
  int steps = 5;
  [[nodiscard]] double greatest() const { return least + steps * step; }
  [[nodiscard]] int x(double value) const {
    return kLeft + static_cast<int>(std::lround((value - least) / (steps * step) * (kWidth - kLeft - kRight)));
  }
};

Axis axis_for(const Distribution& d) {
  Axis axis;
  const double low = std::min(0.0, d.at(0));
  axis.step = round_step(d.at(1) - low);
  axis.least = std::floor(low / axis.step) * axis.step;
  axis.steps = std::max(1, static_cast<int>(std::ceil((d.at(1) - axis.least) / axis.step)));
  return axis;
}

void draw_panel(cv::Mat picture, const Distribution& d, const std::string& title) {
  write(picture, title, {kLeft, 24}, 0.55);
  if (d.values.empty()) return;
  const Axis axis = axis_for(d);
  std::array<int, kBins> bins{};
  for (const double value : d.values) {
    const double share = (value - axis.least) / (axis.greatest() - axis.least);
    ++bins[static_cast<std::size_t>(std::clamp(static_cast<int>(share * kBins), 0, kBins - 1))];
  }
  const int base = kPanelHeight - kBottom;
  const int height = base - kTop;
  const int decades = 1 + static_cast<int>(std::log10(*std::max_element(bins.begin(), bins.end())));
  const auto y = [&](double count) { return base - static_cast<int>(height * std::log10(10 * count) / (decades + 1)); };
  for (int k = 0; k <= decades; ++k) {
    const double count = std::pow(10.0, k);
    cv::line(picture, {kLeft, y(count)}, {kWidth - kRight, y(count)}, kGrid);
    write(picture, number(count), {8, y(count) + 4}, 0.4);
  }
  for (int k = 0; k <= axis.steps; ++k) {
    const double value = axis.least + k * axis.step;
    cv::line(picture, {axis.x(value), base}, {axis.x(value), base + 4}, kInk);
    write(picture, number(value), {axis.x(value) - 10, base + 20}, 0.4);
  }
  const double bar = static_cast<double>(kWidth - kLeft - kRight) / kBins;
  for (int b = 0; b < kBins; ++b) {
    const int count = bins[static_cast<std::size_t>(b)];
    if (count == 0) continue;
    const cv::Point corner(kLeft + static_cast<int>(b * bar), y(count));
    cv::rectangle(picture, corner, {kLeft + static_cast<int>((b + 1) * bar) - 1, base}, kBar, cv::FILLED);
  }
  cv::line(picture, {kLeft, base}, {kWidth - kRight, base}, kInk);
  for (const auto& [share, name] : {std::pair(0.5, "p50"), std::pair(0.99, "p99"), std::pair(0.999, "p99.9")}) {
    const int x = axis.x(d.at(share));
    cv::line(picture, {x, kTop}, {x, base}, kMark);
    // Stacked, since they may stand close together.
    const int row = share < 0.9 ? 0 : share < 0.995 ? 1 : 2;
    write(picture, std::string(name) + " " + number(d.at(share)), {std::min(x + 3, kWidth - 110), kTop + 12 + 14 * row},
          0.4);
  }
}

}  // namespace

Result<> write_latency_picture(const std::filesystem::path& file, const LatencyContext& context,
                               const LatencyRun& run) {
  cv::Mat picture(3 * kPanelHeight, kWidth, CV_8UC3, cv::Scalar(255, 255, 255));
  const auto all = distributions(run);
  const auto find = [&](const std::string& name) -> const Distribution& {
    return *std::find_if(all.begin(), all.end(), [&](const Distribution& d) { return d.name == name; });
  };
  const auto panel = [&](int row) { return picture.rowRange(row * kPanelHeight, (row + 1) * kPanelHeight); };
  draw_panel(panel(0), find("step"),
             "step [ms], " + std::to_string(run.steps.size()) + " results at " + number(context.options.rate_hz) +
                 " Hz, count on a logarithmic scale");
  draw_panel(panel(1), find("exposure to ready"), "mid-exposure to the end of the step [ms]");
  draw_panel(panel(2), find("release after due"), "release after its declared moment [us]");
  return write_picture(file, picture);
}

}  // namespace pelorus
