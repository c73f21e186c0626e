#include "firmware-host/pelorus/eval/ablate_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "firmware-host/pelorus/json_object.h"

namespace pelorus {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kCmPerM = 100.0;

// Mean of what exists.
class Mean {
 public:
  void add(bool exists, double value) {
    if (!exists) return;
    sum_ += value;
    ++count_;
  }
  [[nodiscard]] double value() const { return count_ == 0 ? kUnknown : sum_ / count_; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

std::string cell(const char* pattern, double value, int width) {
  std::array<char, 48> text{};
  if (std::isfinite(value)) {
    std::snprintf(text.data(), text.size(), pattern, value);
  } else {
    text[0] = '-';
  }
  std::string padded = text.data();
  const std::size_t wanted = std::max(static_cast<std::size_t>(width), padded.size() + 1);  // columns never touch
  padded.insert(0, wanted - padded.size(), ' ');
  return padded;
}

std::string row(const std::string& name, const AblationFigures& f) {
  std::array<char, 64> counts{};
  std::array<char, 32> title{};
  std::snprintf(title.data(), title.size(), "%-22s", name.c_str());
  std::snprintf(counts.data(), counts.size(), " %8d %7zu", f.identity_switches, f.false_objects);
  return title.data() + cell("%.4f", f.camera_step_m * kCmPerM, 9) + cell("%.4f", f.camera_absolute_m * kCmPerM, 9) +
         cell("%.4f", f.motion_m * kCmPerM, 10) + cell("%.4f", f.motion_rad * kDegPerRad, 8) +
         cell("%.3f", f.since_birth_m * kCmPerM, 10) + cell("%.3f", f.since_birth_rad * kDegPerRad, 8) +
         cell("%.1f", 100 * f.coverage, 9) + counts.data() + cell("%.1f", 100 * f.right_count_share, 8) +
         cell("%.1f", f.step_median_ms, 8) + "\n";
}

}  // namespace

AblationFigures ablation_figures(const RunEvaluation& run) {
  AblationFigures figures;
  const Evaluation& evaluation = run.evaluation;
  figures.camera_step_m = evaluation.camera ? evaluation.camera->step_m.mean : kUnknown;
  figures.camera_absolute_m = evaluation.camera ? evaluation.camera->absolute_m.mean : kUnknown;
  figures.step_median_ms = run.step_times ? run.step_times->median_ms : kUnknown;
  figures.has_bodies = !evaluation.bodies.empty();
  Mean motion_m, motion_rad, since_birth_m, since_birth_rad, coverage;
  for (const BodyEvaluation& body : evaluation.bodies) {
    motion_m.add(body.motion.step_m.count > 0, body.motion.step_m.median);
    motion_rad.add(body.motion.step_rad.count > 0, body.motion.step_rad.median);
    since_birth_m.add(body.motion.since_birth_m.count > 0, body.motion.since_birth_m.mean);
    since_birth_rad.add(body.motion.since_birth_rad.count > 0, body.motion.since_birth_rad.mean);
    coverage.add(body.score.frames_on_show > 0, body.score.coverage());
    figures.identity_switches += body.score.identity_switches;
  }
  figures.motion_m = motion_m.value();
  figures.motion_rad = motion_rad.value();
  figures.since_birth_m = since_birth_m.value();
  figures.since_birth_rad = since_birth_rad.value();
  figures.coverage = coverage.value();
  figures.false_objects = evaluation.tracking.false_objects.size();
  figures.right_count_share =
      evaluation.knows_bodies ? evaluation.tracking.right_count_share.value_or(kUnknown) : kUnknown;
  return figures;
}

std::string to_table(const std::vector<AblationRun>& runs) {
  std::string text =
      "                          camera [cm]      object motion    since birth   coverage       id   false   right    "
      "step\n"
      "step left out             step absolute  ME cm     deg        cm     deg        %  switches objects  count %"
      "      ms\n";
  for (const AblationRun& run : runs) {
    const std::string name = run.step_off.empty() ? "none (all on)" : run.step_off;
    if (run.result) {
      text += row(name, ablation_figures(*run.result));
    } else {
      text += name;
      text += ": failed: " + run.failure + "\n";
    }
  }
  return text;
}

std::string to_json(const std::vector<AblationRun>& runs) {
  std::vector<std::string> elements;
  for (const AblationRun& run : runs) {
    JsonObject json;
    run.step_off.empty() ? json.raw("step_off", "null") : json.text("step_off", run.step_off);
    if (run.result) {
      const AblationFigures f = ablation_figures(*run.result);
      json.number("camera_step_mean_m", f.camera_step_m)
          .number("camera_absolute_mean_m", f.camera_absolute_m)
          .number("object_step_median_m", f.motion_m)
          .number("object_step_median_rad", f.motion_rad)
          .number("object_since_birth_mean_m", f.since_birth_m)
          .number("object_since_birth_mean_rad", f.since_birth_rad)
          .number("coverage", f.coverage)
          .integer("identity_switches", f.identity_switches)
          .integer("false_objects", static_cast<long long>(f.false_objects))
          .number("right_count_share", f.right_count_share)
          .number("step_median_ms", f.step_median_ms);
    } else {
      json.text("failure", run.failure);
    }
    elements.push_back(json.str());
  }
  return json_array(elements);
}

}  // namespace pelorus
