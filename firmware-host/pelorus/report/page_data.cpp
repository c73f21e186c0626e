#include "firmware-host/pelorus/report/page_data.h"

#include <algorithm>

#include "firmware-host/pelorus/eval/eval_json.h"
#include "firmware-host/pelorus/json_object.h"
#include "firmware-host/pelorus/report/page_charts.h"
#include "firmware-host/pelorus/report/page_scene.h"

namespace pelorus {
namespace {

// What the page lacks, and why.
std::string notes_json(const ReportInput& input, const ShownFrames& shown) {
  std::vector<std::string> notes;
  const auto note = [&notes](const std::string& text) { notes.push_back(text); };
  if (const auto& reason = input.judged.evaluation.incomplete) note("This run is INCOMPLETE: " + *reason + ".");
  if (const auto& doubt = input.judged.evaluation.doubt) note("The truth is DOUBTFUL: " + *doubt + ".");
  if (!input.judged.truth) {
    note(input.judged.evaluation.dataset.empty()
             ? "No data set was named, so errors against truth are not shown."
             : "The data set holds no truth, so errors against truth are not shown.");
  }
  if (shown.stride > 1) {
    note("The replay shows every " + std::to_string(shown.stride) + "th frame of the run.");
  }
  if (input.points.empty()) note("The run holds no points of the scene (points.csv), so none are shown.");
  if (input.thumbnails.pictures.empty() && input.thumbnails.unreadable.empty()) {
    note("The run holds no annotated pictures: repeat the replay with --overlay to see them here.");
  }
  for (const std::string& name : input.thumbnails.unreadable) note("The picture " + name + " cannot be read.");
  if (input.stages.latency_ms.empty()) note("The run holds no timing.csv, so latencies are not shown.");
  std::vector<std::string> quoted;
  for (const std::string& text : notes) quoted.push_back(json_text(text));
  return json_array(quoted);
}

std::string state_names_json() {
  std::vector<std::string> names;
  for (int i = 0; i <= static_cast<int>(VisionState::standby); ++i) {
    names.push_back(json_text(to_text(static_cast<VisionState>(i))));
  }
  return json_array(names);
}

}  // namespace

PageBudget PageBudget::halved() const {
  const auto half = [](std::size_t limit) { return std::max<std::size_t>(2, limit / 2); };
  return {half(replay_frames), half(object_frames), half(static_points),
          half(object_points), half(chart_samples), half(pictures)};
}

std::string page_data(const ReportInput& input, const PageBudget& budget) {
  const ShownFrames shown = shown_frames(input.judged.run, budget);
  return JsonObject()
      .raw("evaluation", to_json(input.judged.evaluation))
      .raw("notes", notes_json(input, shown))
      .raw("state_names", state_names_json())
      .raw("frames", frames_json(input, shown))
      .raw("scene", static_points_json(input, budget))
      .raw("objects", objects_json(input, shown, budget))
      .raw("true_bodies", true_bodies_json(input, shown))
      .raw("states", states_json(input.judged.run))
      .raw("errors", errors_json(input, budget))
      .raw("point_counts", point_counts_json(input, budget))
      .raw("stages", stages_json(input.stages))
      .raw("latency", latency_json(input.stages))
      .raw("pictures", pictures_json(input, budget))
      .str();
}

}  // namespace pelorus
