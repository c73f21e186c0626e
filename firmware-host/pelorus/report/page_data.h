#pragma once
// page_data: everything the page shows, as one JSON object: numbers ready to be drawn and put into tables, none that
// the page would have to compute from others. SI units and radians, `world` frame but for points and outlines of
// bodies (`obj`). Figures that do not exist are null. Pure.

#include <string>
#include <vector>

#include "firmware-host/pelorus/eval/eval_run.h"
#include "firmware-host/pelorus/report/error_series.h"
#include "firmware-host/pelorus/report/thumbnails.h"
#include "firmware-host/pelorus/results/scene_reader.h"
#include "firmware-host/pelorus/results/stage_reader.h"

namespace pelorus {

struct ReportInput {
  JudgedRun judged;
  ErrorSeries errors;  // empty without truth
  std::vector<ScenePoint> points;
  std::vector<SceneOutline> outlines;
  StageRecord stages;
  Thumbnails thumbnails;
};

// Upper bounds of what is embedded, so that the page of a long run stays small; what they leave out the page says.
struct PageBudget {
  std::size_t replay_frames = 1500;
  std::size_t object_frames = 5000;  // poses with outlines, over all objects
  std::size_t static_points = 25000;
  std::size_t object_points = 12000;  // over all objects
  std::size_t chart_samples = 1500;   // of each curve
  std::size_t pictures = 12;

  [[nodiscard]] PageBudget halved() const;
};

[[nodiscard]] std::string page_data(const ReportInput& input, const PageBudget& budget);

}  // namespace pelorus
