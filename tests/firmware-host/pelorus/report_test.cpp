// The figures of the report: the series of errors against what `eval` says, quantiles, bounds of the page.
#include <gtest/gtest.h>

#include <numeric>

#include "core/evaluation/evaluation.h"
#include "firmware-host/pelorus/report/body_names.h"
#include "firmware-host/pelorus/report/error_series.h"
#include "firmware-host/pelorus/report/json_numbers.h"
#include "firmware-host/pelorus/report/latency.h"
#include "firmware-host/pelorus/report/page.h"
#include "firmware-host/pelorus/report/page_charts.h"
#include "firmware-host/pelorus/report/page_scene.h"
#include "firmware-host/pelorus/report/scene_view.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

Rigid3 moved(const Eigen::Vector3d& p, const Eigen::Vector3d& rotation) {
  Rigid3 T = Rigid3::Identity();
  T.translation() = p;
  T.linear() = so3_exp(rotation);
  return T;
}

// A vehicle and one body that moves, both estimated with errors of their own; no pose in frame 4.
struct Dive {
  EstimatedRun run;
  Truth truth;

  explicit Dive(std::size_t frames = 9, std::size_t lost = 4) {
    truth.exact = truth.knows_bodies = true;
    truth.bodies = {"crate"};
    Rigid3 T_world_obj_prev = Rigid3::Identity();
    for (std::size_t i = 0; i < frames; ++i) {
      const double t = static_cast<double>(i);
      const Rigid3 T_truth_cam = moved({0.1 * t, 0, 0.02 * t}, {0, 0.01 * t, 0});
      const Rigid3 T_truth_body = moved({0.2 * t, 0.1, 3}, {0, 0, 0.05 * t});
      TrueFrame true_frame;
      true_frame.T_truth_cam = T_truth_cam;
      true_frame.bodies.push_back(
          {0, T_truth_cam.inverse() * T_truth_body, Eigen::Vector3d(0.5, 0.5, 0.5), 5000, true});
      truth.frames.push_back(true_frame);

      EstimatedFrame frame;
      frame.seq = i;
      frame.capture_time = Timestamp{static_cast<std::int64_t>(i) * 100'000'000};
      frame.state = i == lost ? VisionState::lost : VisionState::tracking;
      if (i != lost) frame.T_world_cam = T_truth_cam * moved({0.001 * t * t, 0.0005, 0}, {0.0001 * t, 0, 0});
      EstimatedObject object;
      object.id = BodyId{7};
      object.phase = i < 2 ? ObjectPhase::tentative : ObjectPhase::confirmed;
      object.T_world_obj = T_truth_body * moved({0.05, 0.002 * t, 0}, {0, 0.001 * t * t, 0});
      object.M_world = object.T_world_obj * T_world_obj_prev.inverse();
      object.centroid_world = object.T_world_obj.translation();
      T_world_obj_prev = object.T_world_obj;
      frame.objects.push_back(object);
      run.push_back(frame);
    }
  }

  [[nodiscard]] ReportInput input() const {
    ReportInput result;
    result.judged.run = run;
    result.judged.truth = truth;
    result.judged.evaluation.has_truth = true;
    result.judged.evaluation.evaluation = evaluate(run, truth, {});
    result.errors = error_series(run, truth, {});
    return result;
  }
};

ErrorStatistics statistics_of(const std::vector<ErrorSample>& samples, double ErrorSample::*which) {
  std::vector<double> values;
  for (const ErrorSample& sample : samples) {
    if (!std::isnan(sample.*which)) values.push_back(sample.*which);
  }
  return summarize(values);
}

void expect_same(const ErrorStatistics& a, const ErrorStatistics& b, const char* what) {
  EXPECT_GT(b.count, 3U) << what;
  EXPECT_GT(b.mean, 1e-6) << what << " is no error at all: the comparison would mean nothing";
  EXPECT_EQ(a.count, b.count) << what;
  EXPECT_DOUBLE_EQ(a.mean, b.mean) << what;
  EXPECT_DOUBLE_EQ(a.max, b.max) << what;
  EXPECT_DOUBLE_EQ(a.rmse, b.rmse) << what;
}

TEST(ErrorSeries, ItsStatisticsAreThoseThatEvalPrints) {
  const Dive dive;
  const ErrorSeries series = error_series(dive.run, dive.truth, {});
  const Evaluation evaluation = evaluate(dive.run, dive.truth, {});
  ASSERT_TRUE(evaluation.camera);
  expect_same(statistics_of(series.camera, &ErrorSample::step_m), evaluation.camera->step_m, "step");
  expect_same(statistics_of(series.camera, &ErrorSample::step_rad), evaluation.camera->step_rad, "step rotation");
  expect_same(statistics_of(series.camera, &ErrorSample::absolute_m), evaluation.camera->absolute_m, "absolute");
  expect_same(statistics_of(series.camera, &ErrorSample::absolute_rad), evaluation.camera->absolute_rad, "rotation");
  ASSERT_EQ(series.bodies.size(), 1U);
  ASSERT_EQ(evaluation.bodies.size(), 1U);
  const std::vector<ErrorSample>& body = series.bodies[0].samples;
  const MotionError& motion = evaluation.bodies[0].motion;
  expect_same(statistics_of(body, &ErrorSample::step_m), motion.step_m, "body step");
  expect_same(statistics_of(body, &ErrorSample::step_rad), motion.step_rad, "body step rotation");
  expect_same(statistics_of(body, &ErrorSample::absolute_m), motion.since_birth_m, "body since birth");
  expect_same(statistics_of(body, &ErrorSample::absolute_rad), motion.since_birth_rad, "body rotation since birth");
}

TEST(ErrorSeries, AHoleInThePosesIsNoStep) {
  const Dive dive;
  for (const ErrorSample& sample : error_series(dive.run, dive.truth, {}).camera) {
    EXPECT_NE(sample.frame, 4U);
    EXPECT_EQ(std::isnan(sample.step_m), sample.frame == 5U) << sample.frame;
  }
}

TEST(Latency, QuantilesAreMeasuredValuesThatTheirShareDoesNotExceed) {
  std::vector<double> times_ms(1000);
  std::iota(times_ms.begin(), times_ms.end(), 1.0);  // 1..1000
  const LatencyHistogram histogram = latency_histogram(times_ms);
  EXPECT_DOUBLE_EQ(histogram.p50_ms, 500);
  EXPECT_DOUBLE_EQ(histogram.p99_ms, 990);
  EXPECT_DOUBLE_EQ(histogram.p999_ms, 999);
  EXPECT_DOUBLE_EQ(histogram.max_ms, 1000);
  EXPECT_DOUBLE_EQ(histogram.mean_ms, 500.5);
}

TEST(Latency, BinsAdjoinAndHoldEveryFrameOnce) {
  const LatencyHistogram histogram = latency_histogram({0, 3, 10, 10.5, 100, 99.99});
  std::int64_t frames = 0;
  for (std::size_t i = 0; i < histogram.bins.size(); ++i) {
    frames += histogram.bins[i].frames;
    if (i > 0) {
      EXPECT_DOUBLE_EQ(histogram.bins[i].low_ms, histogram.bins[i - 1].high_ms);
    }
  }
  EXPECT_EQ(frames, 6);
  EXPECT_GE(histogram.bins.back().high_ms, 100);
  EXPECT_EQ(latency_histogram({}).frames, 0);
}

std::vector<ScenePoint> floor_points(const Eigen::Vector3d& normal, double thickness_m) {
  const Eigen::Vector3d a = normal.unitOrthogonal();
  const Eigen::Vector3d b = normal.cross(a);
  std::vector<ScenePoint> points;
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) {
      ScenePoint point;
      point.p_body = 4 * normal + 0.2 * i * a + 0.2 * j * b + ((i + j) % 2 == 0 ? thickness_m : 0) * normal;
      point.views = 10 + i;
      points.push_back(point);
    }
  }
  return points;
}

TEST(ViewAxes, UpIsTheNormalOfThePlaneOnTheVehiclesSide) {
  const Dive dive;
  const Eigen::Vector3d down = Eigen::Vector3d(0.1, 0.4, 1).normalized();
  const ViewAxes axes = view_axes(dive.run, floor_points(down, 0.05));
  EXPECT_TRUE(axes.from_plane);
  EXPECT_GT(axes.R_view_world.row(2).dot(-down), 0.999);
  EXPECT_NEAR(axes.R_view_world.determinant(), 1, 1e-9);
  // The vehicle goes along x of the view.
  const Eigen::Vector3d track =
      dive.run.back().T_world_cam->translation() - dive.run.front().T_world_cam->translation();
  EXPECT_GT((axes.R_view_world * track).x(), 0);
  EXPECT_NEAR((axes.R_view_world * track).y(), 0, 1e-9);
}

TEST(ViewAxes, ACloudThatIsNoPlaneLeavesTheCamerasOwnUp) {
  const Dive dive;
  const ViewAxes axes = view_axes(dive.run, floor_points(Eigen::Vector3d::UnitZ(), 4));
  EXPECT_FALSE(axes.from_plane);
  EXPECT_NEAR(axes.R_view_world(2, 1), -1, 1e-9);
}

TEST(Thinning, KeepsTheLimitAndThePointsSeenMostOften) {
  const std::vector<ScenePoint> points = floor_points(Eigen::Vector3d::UnitZ(), 0);
  EXPECT_EQ(thinned(points, points.size()).size(), points.size());
  const std::vector<ScenePoint> kept = thinned(points, 50);
  EXPECT_LE(kept.size(), 50U);
  EXPECT_GT(kept.size(), 15U);
  const auto mean_views = [](const std::vector<ScenePoint>& some) {
    double sum = 0;
    for (const ScenePoint& point : some) sum += point.views;
    return sum / static_cast<double>(some.size());
  };
  EXPECT_GT(mean_views(kept), mean_views(points));
}

TEST(JsonNumbers, AreShortAndNeverNan) {
  EXPECT_EQ(JsonNumbers(3).add(1.5).add(-0.0001).add(2).add(std::nan("")).str(), "[1.5,0,2,null]");
}

TEST(FilledPage, DataCannotEndItsElement) {
  const Result<std::string> page = filled_page("<x>\"PELORUS_RUN_DATA\"</x>", "{\"a\":\"</x><!--\"}");
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(page.value(), "<x>{\"a\":\"\\u003c/x>\\u003c!--\"}</x>");
  EXPECT_FALSE(filled_page("<x></x>", "{}").ok());
  const Result<std::string> absent = filled_page("", "{}");
  ASSERT_FALSE(absent.ok());
  EXPECT_NE(absent.error().message().find("PELORUS_WITH_REPORT"), std::string::npos);
}

// Long, busy, and finely reconstructed: everything at once.
TEST(Page, OfALongRunStaysBelowItsBoundAndSaysWhatItLeavesOut) {
  if (page_template().empty()) GTEST_SKIP() << "built without the report page";
  const Dive dive(20000);
  ReportInput input = dive.input();
  for (std::size_t i = 0; i < 200000; ++i) {
    ScenePoint point;
    const double n = static_cast<double>(i);
    point.body = BodyId{i % 4 == 0 ? 7 : 0};
    point.p_body = Eigen::Vector3d(std::fmod(n * 0.754877, 900), std::fmod(n * 0.569840, 1) * 500, std::fmod(n, 7));
    input.points.push_back(point);
  }
  for (const EstimatedFrame& frame : dive.run) {
    SceneOutline outline{frame.capture_time, BodyId{7}, {}};
    for (int corner = 0; corner < 16; ++corner) outline.corners_obj.emplace_back(-1.234 * corner, 2.345, 3.456);
    input.outlines.push_back(outline);
  }
  input.thumbnails.pictures.assign(12, {5, std::string(150'000, 'A')});
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "page.html";
  ASSERT_TRUE(write_page(file, input).ok());
  EXPECT_LE(std::filesystem::file_size(file), kLargestPage);
  EXPECT_NE(test::read_text(file).find("The replay shows every"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".partial"));
  const std::size_t half = std::filesystem::file_size(file) / 2;
  ASSERT_TRUE(write_page(file, input, half).ok());
  EXPECT_LE(std::filesystem::file_size(file), half);
}

TEST(Page, ThatCannotBeWrittenIsAnErrorAndLeavesNothing) {
  if (page_template().empty()) GTEST_SKIP() << "built without the report page";
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "nowhere" / "page.html";
  const Result<Ok> written = write_page(file, Dive().input());
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::io);
  EXPECT_NE(written.error().message().find("page.html"), std::string::npos);
  // A folder in the page's place: the rename fails, the partial file goes.
  std::filesystem::create_directories(folder.path() / "taken.html" / "x");
  EXPECT_FALSE(write_page(folder.path() / "taken.html", Dive().input()).ok());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "taken.html.partial"));
}

TEST(Replayed, FramesWithoutAPoseAreNullAndObjectsKnowTheirFrames) {
  const Dive dive;
  const ReportInput input = dive.input();
  const ShownFrames shown = shown_frames(dive.run, {});
  EXPECT_EQ(shown.stride, 1U);
  EXPECT_NE(frames_json(input, shown).find("null,null,null,null,null,null,null"), std::string::npos);
  // Tentative in frames 0 and 1: not shown.
  EXPECT_NE(objects_json(input, shown, {}).find("\"frame\":[2,3,4,5,6,7,8]"), std::string::npos);
}

TEST(BodyNames, OneNameForABodyWhereverThePageTellsOfIt) {
  const Dive dive;
  const ReportInput input = dive.input();
  EXPECT_EQ(body_name(input, input.errors.bodies.at(0)), "#7 crate");
  EXPECT_EQ(object_name(input, BodyId{7}), "#7 crate");
  EXPECT_EQ(object_name(input, BodyId{8}), "#8") << "no body of the truth";
  const std::string name = "\"name\":\"#7 crate\"";
  EXPECT_NE(objects_json(input, shown_frames(dive.run, {}), {}).find(name), std::string::npos);
  EXPECT_NE(errors_json(input, {}).find(name), std::string::npos);
}

TEST(BodyNames, BesideACurveTheNumbersOfABodyAreCounted) {
  const Dive dive;
  ReportInput input = dive.input();
  BodyErrors& errors = input.errors.bodies.at(0);
  EXPECT_EQ(short_body_name(input, errors), "#7 crate");
  const ErrorSample sample = errors.samples.front();
  errors.samples.push_back(sample);
  errors.samples.back().object = BodyId{1};
  EXPECT_EQ(short_body_name(input, errors), "#1 #7 crate");
  for (int id = 2; id <= 20; ++id) {
    errors.samples.push_back(sample);
    errors.samples.back().object = BodyId{id};
  }
  EXPECT_EQ(short_body_name(input, errors), "#1 +19 crate");
  EXPECT_NE(body_name(input, errors).find("#1 #2 #3 "), std::string::npos) << "elsewhere all of them";
  EXPECT_NE(errors_json(input, {}).find("\"short_name\":\"#1 +19 crate\""), std::string::npos);
}

}  // namespace
}  // namespace pelorus
