#include "firmware-host/pelorus/eval/eval_table.h"

#include <cmath>
#include <numbers>

#include "firmware-host/pelorus/formatted.h"

namespace pelorus {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kCmPerM = 100.0;

struct Goal {
  std::string text;  // empty = none
  bool met = false;
};
// `scale` brings both to the `unit` shown.
Goal below(double value, const std::optional<double>& limit, double scale, const char* unit) {
  return limit ? Goal{formatted("< %g %s", *limit * scale, unit), value < *limit} : Goal{};
}
Goal at_most(std::size_t count, const std::optional<double>& limit) {
  return limit ? Goal{formatted("%g", *limit), static_cast<double>(count) <= *limit} : Goal{};
}
Goal above_percent(const std::optional<double>& share, const std::optional<double>& limit_percent) {
  return share && limit_percent ? Goal{formatted("> %g %%", *limit_percent), 100 * *share > *limit_percent} : Goal{};
}

std::string share_text(const std::optional<double>& share) { return share ? formatted("%.1f %%", 100 * *share) : "-"; }

std::string line(const std::string& name, const std::string& value, const Goal& goal = {},
                 const std::string& paper = "") {
  const char* verdict = goal.text.empty() ? "" : goal.met ? "ok" : "MISSED";
  std::string text =
      formatted("  %-34s %20s   %-10s %-8s %s", name.c_str(), value.c_str(), goal.text.c_str(), verdict, paper.c_str());
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

std::string heading(const std::string& name) {
  return "\n" + formatted("%-36s %20s   %-10s %-8s %s\n", name.c_str(), "value", "goal", "", "paper");
}

std::string facts_text(const RunEvaluation& run) {
  const RunFacts& facts = run.evaluation.facts;
  std::string text = "Run    " + run.folder + "\n";
  if (run.incomplete) text += "       INCOMPLETE: " + *run.incomplete + "\n";
  const std::string lost = run.lost ? to_text(*run.lost) : std::to_string(facts.frames_missed) + " in gaps";
  text += formatted("       %zu stepped, %s, %zu with a pose\n       resets %d;", facts.frames, lost.c_str(),
                    facts.frames_with_pose, facts.resets);
  for (std::size_t i = 0; i < facts.states.size(); ++i) {
    if (facts.states[i] > 0) text += formatted(" %s %zu", to_text(static_cast<VisionState>(i)), facts.states[i]);
  }
  text += formatted("\n       %zu objects confirmed", facts.confirmed.size());
  if (run.step_times) {
    text += formatted("; step median %.1f ms, p99 %.1f ms", run.step_times->median_ms, run.step_times->p99_ms);
  }
  return text + "\nTruth  " + (run.has_truth ? run.truth_origin : "none") + "\n" +
         (run.doubt ? "       DOUBTFUL: " + *run.doubt + "\n" : "");
}

// Lengths where they read best: centimetres for dives, metres for roads.
std::string length(double value_m, bool fine) {
  return fine ? formatted("%.4f cm", value_m * kCmPerM) : formatted("%.4f m", value_m);
}
std::string angle(double value_rad) { return formatted("%.4f deg", value_rad * kDegPerRad); }

std::string consistency_line(const std::string& name, const Consistency& nees) {
  if (nees.count == 0) return line(name, "no covariance");
  return line(name, formatted("%.2f (median %.2f)", nees.mean_nees, nees.median_nees),
              {formatted("%.1f-%.1f", nees.band_low, nees.band_high), nees.is_inside_band()});
}

constexpr double kStandstill_m = 0.5;

std::string camera_text(const RunEvaluation& run) {
  const TrajectoryError& camera = *run.evaluation.camera;
  const bool dive = run.exact_truth;
  const bool rests = !dive && camera.path_length_m < kStandstill_m;
  const bool fine = dive || rests;
  const Goals& goals = run.goals;
  const auto length_goal = [fine](double value_m, const std::optional<double>& limit_m) {
    return fine ? below(value_m, limit_m, kCmPerM, "cm") : below(value_m, limit_m, 1, "m");
  };
  const auto angle_goal = [](double value_rad, const std::optional<double>& limit_deg) {
    return below(value_rad * kDegPerRad, limit_deg, 1, "deg");
  };
  // Absolute errors grow with the path: a goal for a shorter one says nothing.
  const bool within_path = camera.path_length_m <= goals.camera_absolute_path_m.value_or(camera.path_length_m);
  std::string text = heading(formatted("Camera, %.2f m, %zu poses", camera.path_length_m, camera.poses));
  text += line("step error, mean", length(camera.step_m.mean, fine),
               length_goal(camera.step_m.mean, goals.camera_step_m), dive ? "0.01 cm" : "");
  text += line("step error, RMSE (RPE)", length(camera.step_m.rmse, fine),
               length_goal(camera.step_m.rmse, goals.camera_step_rmse_m));
  text += line("step rotation, mean", angle(camera.step_rad.mean));
  text += line("step rotation, RMSE (RPE)", angle(camera.step_rad.rmse),
               angle_goal(camera.step_rad.rmse, goals.camera_step_rmse_deg));
  text +=
      line("absolute error, mean", length(camera.absolute_m.mean, fine),
           within_path ? length_goal(camera.absolute_m.mean, goals.camera_absolute_m) : Goal{}, dive ? "0.13 cm" : "");
  text += line("absolute error, max", length(camera.absolute_m.max, fine),
               length_goal(camera.absolute_m.max, goals.camera_absolute_max_m));
  text += line("absolute rotation, mean", angle(camera.absolute_rad.mean));
  text += line("absolute rotation, max", angle(camera.absolute_rad.max),
               angle_goal(camera.absolute_rad.max, goals.camera_absolute_max_deg));
  text += line("ATE, RMSE after alignment", length(camera.ate_rmse_m, fine));
  text += line("final drift", length(camera.final_drift_m, fine));
  if (camera.final_drift_percent) {
    text += line("final drift over the path", formatted("%.3f %%", *camera.final_drift_percent),
                 below(*camera.final_drift_percent, goals.camera_drift_percent, 1, "%"));
  }
  if (camera.kitti) {
    text += line("KITTI drift, 100-800 m", formatted("%.3f %%", camera.kitti->translation_percent),
                 below(camera.kitti->translation_percent, goals.camera_drift_percent, 1, "%"));
    text += line("KITTI rotation, 100-800 m", formatted("%.4f deg/100m", camera.kitti->rotation_deg_per_100m));
  }
  // A measured truth has noise of its own, larger than ours: consistency with it would mean nothing.
  if (dive && run.evaluation.camera_consistency) {
    text += consistency_line("NEES of the step", *run.evaluation.camera_consistency);
  }
  return text;
}

std::string body_ids(const BodyScore& score) {
  std::string ids;
  for (const BodyId id : score.ids) ids += (ids.empty() ? "" : ",") + std::to_string(id.value);
  return ids.empty() ? "-" : ids;
}

// A length in cm and an angle in degrees, "-" where there are none.
std::string pair_cells(const ErrorStatistics& metres, const ErrorStatistics& radians, double ErrorStatistics::*which) {
  if (metres.count == 0) return formatted("%8s%7s", "-", "-");
  return formatted("%8.3f%7.3f", metres.*which * kCmPerM, radians.*which * kDegPerRad);
}

std::string body_line(const BodyEvaluation& body, bool exact) {
  const MotionError& motion = body.motion;
  const BodyScore& score = body.score;
  const std::string detected = score.time_to_detection_s ? formatted("%.2f s", *score.time_to_detection_s) : "never";
  const std::string coverage = score.frames_on_show == 0 ? "-" : formatted("%.1f %%", 100 * score.coverage());
  const std::string nees = !exact || body.consistency.count == 0 ? "-" : formatted("%.2f", body.consistency.mean_nees);
  return formatted("  %-12s", body.name.c_str()) +
         pair_cells(motion.step_m, motion.step_rad, &ErrorStatistics::median) +
         pair_cells(motion.step_m, motion.step_rad, &ErrorStatistics::mean) +
         pair_cells(motion.since_birth_m, motion.since_birth_rad, &ErrorStatistics::mean) +
         pair_cells(motion.since_birth_m, motion.since_birth_rad, &ErrorStatistics::max) +
         formatted(" %9s %8d %9s %7s  %s\n", coverage.c_str(), score.identity_switches, detected.c_str(), nees.c_str(),
                   body_ids(score).c_str());
}

// A row over the bodies' figures; empty without goals for them.
std::string body_goals(const Goals& goals) {
  const auto limit = [](const std::optional<double>& value, double scale) {
    return value ? formatted("< %g", *value * scale) : std::string();
  };
  const std::string step_m = limit(goals.body_step_m, kCmPerM), step_deg = limit(goals.body_step_deg, 1);
  const std::string since_m = limit(goals.body_since_birth_m, kCmPerM),
                    since_deg = limit(goals.body_since_birth_deg, 1);
  const std::string coverage = goals.body_coverage_percent ? formatted("> %g %%", *goals.body_coverage_percent) : "";
  if ((step_m + step_deg + since_m + since_deg + coverage).empty()) return "";
  return formatted("  %-12s%8s%7s%15s%8s%7s%15s %9s %8d %9s %7d  one\n", "goal", step_m.c_str(), step_deg.c_str(), "",
                   since_m.c_str(), since_deg.c_str(), "", coverage.c_str(), 0, "", 6);
}

std::string bodies_text(const RunEvaluation& run) {
  if (run.evaluation.bodies.empty()) return "";
  std::string text =
      "\nMoving bodies   step, median    step, mean     since birth    since birth             id\n"
      "                      (ME)                         mean            max\n"
      "                   cm    deg      cm    deg      cm    deg      cm    deg  coverage switches  detected    NEES"
      "  ids\n";
  text += body_goals(run.goals);
  for (const BodyEvaluation& body : run.evaluation.bodies) text += body_line(body, run.exact_truth);
  return text;
}

std::string tracking_text(const RunEvaluation& run) {
  const TrackingScore& tracking = run.evaluation.tracking;
  std::string text = heading("Objects as a whole");
  if (!run.evaluation.bodies.empty() || !tracking.false_objects.empty()) {
    text += line("right number of motions", share_text(tracking.right_count_share),
                 above_percent(tracking.right_count_share, run.goals.right_count_percent));
    text += line("  1 s after each body's appearing", share_text(tracking.right_count_settled_share));
  }
  text += line("false objects",
               formatted("%zu (%.1f per 1000)", tracking.false_objects.size(), tracking.false_per_1000_frames),
               at_most(tracking.false_objects.size(), run.goals.false_objects));
  if (run.exact_truth && !run.evaluation.bodies.empty()) {
    text += consistency_line("NEES of object motion", run.evaluation.object_consistency);
  }
  for (const FalseObject& object : tracking.false_objects) {
    const std::string where = !object.resting_body.empty() ? "on " + object.resting_body + ", at rest"
                              : object.duplicate           ? "second object on a body that has one"
                                                           : "on the background";
    text += formatted("    object %d, confirmed in %zu frames: %s\n", object.id.value, object.frames, where.c_str());
  }
  return text;
}

}  // namespace

std::string to_table(const RunEvaluation& run) {
  std::string text = facts_text(run);
  if (!run.has_truth) return text;
  if (run.evaluation.camera) text += camera_text(run);
  if (run.evaluation.knows_bodies) text += bodies_text(run) + tracking_text(run);
  return text;
}

}  // namespace pelorus
