#include "core/refine/body_window.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/point_world.h"

namespace pelorus {
namespace {

using test::kRig;
using test::twist;

// A cloud of points in the body's own frame, seen along a path of true poses T_cam_body.
struct Film {
  std::vector<Eigen::Vector3d> p_body;
  std::vector<Rigid3> T_cam_body;

  Film(int points, int frames, const Vector6d& step) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> side(-0.4, 0.4);
    for (int i = 0; i < points; ++i) p_body.emplace_back(side(random), side(random), side(random));
    const Rigid3 T_start = Rigid3(Eigen::Translation3d(0.1, 0, 2.0));
    for (int k = 0; k < frames; ++k) T_cam_body.push_back(T_start * se3_exp(k * step));
  }
  [[nodiscard]] std::vector<WindowObservation> observe(std::size_t frame, double noise_px, double sigma_px,
                                                       std::mt19937_64& random) const {
    std::normal_distribution<double> noise(0, 1);
    std::vector<WindowObservation> seen;
    for (std::size_t i = 0; i < p_body.size(); ++i) {
      const Eigen::Vector3d n(noise(random), noise(random), noise(random));
      seen.push_back({TrackId{i + 1}, kRig.project(T_cam_body[frame] * p_body[i]) + noise_px * n, sigma_px});
    }
    return seen;
  }
};

Timestamp at_frame(std::size_t frame) { return Timestamp{} + Duration(static_cast<std::int64_t>(frame) * 100000000); }

// Every frame starts from the adjusted one before and a motion that is a little wrong, as two-frame motions are.
StageOutcome run(BodyWindow& window, const Film& film, double noise_px, double sigma_px, std::uint64_t seed,
                 double start_error = 0.003) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, start_error > 0 ? start_error : 1e-12);
  StageOutcome outcome = StageOutcome::not_run;
  for (std::size_t k = 0; k < film.T_cam_body.size(); ++k) {
    Rigid3 T_start = film.T_cam_body[0];
    if (k > 0) {
      Vector6d off;
      for (int d = 0; d < 6; ++d) off[d] = noise(random);
      T_start = se3_exp(off) * film.T_cam_body[k] * film.T_cam_body[k - 1].inverse() * window.T_cam_body();
    }
    window.add_frame(kRig, at_frame(k), T_start, Rigid3::Identity(), film.observe(k, noise_px, sigma_px, random));
    if (k > 0) outcome = window.adjust(kRig);
  }
  return outcome;
}

TEST(BodyWindow, FindsTheExactPathOfExactPoints) {
  const Film film(40, 5, twist(0.02, 0.01, -0.02, 0.01, 0.005, -0.01));
  BodyWindow window({.iterations = 6});
  ASSERT_EQ(run(window, film, 0, 0.1, 1), StageOutcome::ok);
  EXPECT_LT(se3_log(window.T_cam_body() * film.T_cam_body[4].inverse()).norm(), 1e-6);
  EXPECT_LT(se3_log(window.T_cam_body_previous() * film.T_cam_body[3].inverse()).norm(), 1e-6);
}

struct MeanNees {
  double T_cam_body = 0;
  double H_curr_prev = 0;
};

MeanNees nees_over_trials(const BodyWindowConfig& config) {
  constexpr int kTrials = 200;
  const Film film(40, 5, twist(0.004, 0.002, -0.003, 0.001, 0.0005, -0.001));
  MeanNees mean;
  for (int trial = 0; trial < kTrials; ++trial) {
    BodyWindow window(config);
    EXPECT_EQ(run(window, film, 0.25, 0.25, 50 + static_cast<std::uint64_t>(trial)), StageOutcome::ok);
    const Vector6d xi_T = se3_log(film.T_cam_body[4] * window.T_cam_body().inverse());
    const Rigid3 H_true = film.T_cam_body[4] * film.T_cam_body[3].inverse();
    const Rigid3 H_curr_prev = window.T_cam_body() * window.T_cam_body_previous().inverse();
    const Vector6d xi_H = se3_log(H_true * H_curr_prev.inverse());
    mean.T_cam_body += xi_T.dot(window.cov_T_cam_body().inverse() * xi_T) / kTrials;
    mean.H_curr_prev += xi_H.dot(window.cov_H_curr_prev().inverse() * xi_H) / kTrials;
  }
  return mean;
}

TEST(BodyWindow, CovariancesTellTheTrueErrorsOver200Trials) {
  // Gaussian noise alone: what protects from other errors is switched off.
  const MeanNees nees = nees_over_trials({.view_change_rad = 1e3, .iterations = 4, .robust_chi2 = 1e6});
  // Mean of 200 chi-squares of 6 degrees of freedom: 6 +- 0.48 at 95 %; a little wider for the estimated scale.
  EXPECT_NEAR(nees.T_cam_body, 6.0, 0.75);
  EXPECT_NEAR(nees.H_curr_prev, 6.0, 0.75);
}

TEST(BodyWindow, WithItsGuardsOnTheCovariancesAreCautiousByLessThanTwo) {
  const MeanNees nees = nees_over_trials({});
  EXPECT_GT(nees.T_cam_body, 3.0);
  EXPECT_LT(nees.T_cam_body, 6.5);
  EXPECT_GT(nees.H_curr_prev, 3.0);
  EXPECT_LT(nees.H_curr_prev, 6.5);
}

TEST(BodyWindow, AtRestItDoesNotDrift) {
  // 60 frames, ten windows' worth: pulled along by its own estimates it would walk away by many deviations.
  const Film film(60, 60, twist(0, 0, 0, 0, 0, 0));
  BodyWindow window({});
  ASSERT_EQ(run(window, film, 0.25, 0.25, 3, 0.001), StageOutcome::ok);
  const Rigid3 E = window.T_cam_body() * film.T_cam_body[0].inverse();
  const Eigen::Vector3d center = film.T_cam_body[0].translation();
  // The body's center from one frame of 60 points: depth deviation z^2 sqrt(2) sigma / (f b sqrt(60)) = 1.9 mm.
  EXPECT_LT((E * center - center).norm(), 4 * 0.0019);
  EXPECT_LT(rotation_angle_rad(E.linear()), 0.02);
  EXPECT_LE(window.frames(), kMaxWindowFrames);
}

TEST(BodyWindow, AFramesReferenceDoesNotMatter) {
  const Film film(30, 8, twist(0.02, 0.01, -0.02, 0.01, 0.005, -0.01));
  Film other = film;
  const Rigid3 T_obj_other = se3_exp(twist(3, -2, 1, 0.5, 0.2, -1));
  for (auto& p : other.p_body) p = T_obj_other.inverse() * p;
  for (auto& T : other.T_cam_body) T = T * T_obj_other;
  BodyWindow window({.iterations = 6});
  BodyWindow window_other({.iterations = 6});
  ASSERT_EQ(run(window, film, 0.25, 0.25, 9), StageOutcome::ok);
  ASSERT_EQ(run(window_other, other, 0.25, 0.25, 9), StageOutcome::ok);
  EXPECT_TRUE((window_other.T_cam_body() * T_obj_other.inverse()).isApprox(window.T_cam_body(), 1e-5));
}

TEST(BodyWindow, InAnotherFrameTheSameBodyMovesTheSame) {
  const Film film(40, 6, twist(0.02, 0.01, -0.02, 0.01, 0.005, -0.01));
  const Rigid3 T_new_old = se3_exp(twist(0.3, -0.2, 0.1, 0.4, 0.1, -0.2));
  BodyWindow window({});
  BodyWindow changed({});
  for (BodyWindow* w : {&window, &changed}) {
    std::mt19937_64 random(7);
    Rigid3 T_start = film.T_cam_body[0];
    for (std::size_t k = 0; k < film.T_cam_body.size(); ++k) {
      if (k > 0) T_start = film.T_cam_body[k] * film.T_cam_body[k - 1].inverse() * w->T_cam_body();
      w->add_frame(kRig, at_frame(k), T_start, Rigid3::Identity(), film.observe(k, 0.1, 0.1, random));
      if (k > 0) {
        ASSERT_EQ(w->adjust(kRig), StageOutcome::ok);
      }
      if (w == &changed && k == 3) w->change_frame(T_new_old);
    }
  }
  EXPECT_LT(se3_log(changed.T_cam_body() * T_new_old * window.T_cam_body().inverse()).norm(), 1e-6);
  EXPECT_LT((changed.find(TrackId{5})->p_body - T_new_old * window.find(TrackId{5})->p_body).norm(), 1e-6);
  EXPECT_LT((changed.cov_H_curr_prev() - window.cov_H_curr_prev()).norm(), 1e-6 * window.cov_H_curr_prev().norm());
}

TEST(BodyWindow, TwoSharedPointsAreTooFewAndThePoseStaysAsGiven) {
  const Film film(2, 2, twist(0.02, 0, 0, 0, 0, 0));
  BodyWindow window({});
  EXPECT_EQ(run(window, film, 0, 0.1, 1, 0), StageOutcome::too_few_points);
  EXPECT_TRUE(window.T_cam_body().isApprox(film.T_cam_body[1], 1e-9));
}

TEST(BodyWindow, AFalsePointIsKnownByItsResidualAndCanBeRemoved) {
  const Film film(30, 5, twist(0.01, 0, 0, 0, 0.01, 0));
  BodyWindow window({});
  std::mt19937_64 random(2);
  for (std::size_t k = 0; k < 5; ++k) {
    auto seen = film.observe(k, 0.1, 0.1, random);
    seen[7].z_px += static_cast<double>(k) * Eigen::Vector3d(2, 1, 2);  // slides over the body
    window.add_frame(kRig, at_frame(k), film.T_cam_body[k], Rigid3::Identity(), seen);
    if (k > 0) {
      ASSERT_EQ(window.adjust(kRig), StageOutcome::ok);
    }
  }
  const BodyPoint* worst = &window.points()[0];
  for (const BodyPoint& point : window.points()) {
    if (point.chi2_mean > worst->chi2_mean) worst = &point;
  }
  EXPECT_EQ(worst->track, TrackId{8});
  EXPECT_GT(worst->chi2_mean, 12.0);
  EXPECT_LT(se3_log(window.T_cam_body() * film.T_cam_body[4].inverse()).norm(), 0.005);
  window.remove(TrackId{8});
  EXPECT_EQ(window.find(TrackId{8}), nullptr);
  EXPECT_NE(window.find(TrackId{9}), nullptr);
}

}  // namespace
}  // namespace pelorus
