#include "firmware-host/runtime/config_fields.h"

#include "firmware-host/runtime/field_list.h"

namespace pelorus {
namespace {

constexpr double kMaxChi2 = 1e4;  // gates: from closed to wide open

void list(FieldList& f, MethodSteps& c) {
  f.section("steps");
  f.add("rigidity_grouping", c.rigidity_grouping);
  f.add("motion_reassignment", c.motion_reassignment);
  f.add("static_criteria", c.static_criteria);
  f.add("bundle_adjustment", c.bundle_adjustment);
  f.add("repartition", c.repartition);
  f.add("net_filter", c.net_filter);
  f.add("ray_filter", c.ray_filter);
  f.add("hull_membership", c.hull_membership);
  f.add("identity_mismatch", c.identity_mismatch);
  f.add("merge_split", c.merge_split);
  f.add("object_window", c.object_window);
  f.add("static_window", c.static_window);
  f.add("reidentification", c.reidentification);
  f.add("object_refill", c.object_refill);
  f.add("motion_prediction", c.motion_prediction);
}

void list(FieldList& f, FrontEndConfig& c) {
  f.section("front_end");
  f.add("max_points", c.max_points, 50, 2000);
  f.add("cell_columns", c.cell_columns, 1, 64);
  f.add("cell_rows", c.cell_rows, 1, 64);
  f.add("min_distance_px", c.min_distance_px, 1, 100);
  f.add("min_distance_object_px", c.min_distance_object_px, 1, 100);
  f.add("max_points_per_object", c.max_points_per_object, 4, 1000);
  f.add("forward_backward_px", c.forward_backward_px, 0.01, 10);
  f.add("min_disparity_px", c.min_disparity_px, 0.1, 100);
  f.add("reference_agreement_px", c.reference_agreement_px, 0.01, 10);
  f.add("reference_min_ncc", c.reference_min_ncc, 0, 1);
  f.add("slope_radius_px", c.slope_radius_px, 1, 1000);
  f.add("max_slope", c.max_slope, 0, 10);
  f.add("reference_spacing", c.reference_spacing, 1, 100);
  f.add("reference_images", c.reference_images, 0, 32);
  f.add("refill_below", c.refill_below, 0, 1);
  f.add("refill_every", c.refill_every, 1, 1000);
  f.add("bridge_below", c.bridge_below, 0, 1);
  f.add("bridge_points", c.bridge_points, 10, 20000);
  f.add("bridge_radius_px", c.bridge_radius_px, 1, 5000);
}

void list(FieldList& f, KltConfig& c) {
  f.section("klt");
  f.add("half_window_px", c.half_window_px, 2, 7);
  f.add("levels", c.levels, 1, 8);
  f.add("max_iterations", c.max_iterations, 1, 100);
  f.add("epsilon_px", c.epsilon_px, 1e-4, 1);
  f.add("min_ncc", c.min_ncc, 0, 1);
  f.add("confirmed_ncc", c.confirmed_ncc, 0, 1);
  f.add("min_eigenvalue", c.min_eigenvalue, 0, 1e4);
}

void list(FieldList& f, StereoMatchConfig& c) {
  f.section("stereo");
  f.add("min_disparity_px", c.min_disparity_px, 0, 1000);
  f.add("max_disparity_px", c.max_disparity_px, 1, 4000);
  f.add("search_level", c.search_level, 0, 7);
  f.add("search_half_window_px", c.search_half_window_px, 2, 7);
  f.add("min_ncc", c.min_ncc, 0, 1);
  f.add("max_rival_ratio", c.max_rival_ratio, 0, 1);
  f.add("max_return_px", c.max_return_px, 0.01, 10);
}

void list(FieldList& f, SurfConfig& c) {
  f.section("surf");
  f.add("octaves", c.octaves, 1, 4);
  f.add("intervals", c.intervals, 3, 5);
  f.add("sampling_step_px", c.sampling_step, 1, 4);
  f.add("threshold", c.threshold, 0, 1e6);
  f.add("faint_threshold", c.faint_threshold, 0, 1e6);
  f.add("upright", c.upright);
  f.add("max_points", c.max_points, 10, 10000);
  f.add("distinct", c.distinct);
}

void list(FieldList& f, SurfMatchConfig& c) {
  f.section("surf_match");
  f.add("max_ratio", c.max_ratio, 0, 1);
  f.add("max_distance", c.max_distance, 0, 2);
  f.add("max_points", c.max_points, 10, 10000);
}

void list(FieldList& f, SeedPointsConfig& c) {
  f.section("seed_points");
  f.add("columns", c.columns, 1, 64);
  f.add("rows", c.rows, 1, 64);
  f.add("density_radius_px", c.density_radius_px, 1, 1000);
  f.add("density_cap", c.density_cap, 1, 1000);
  f.add("error_weight", c.error_weight, 0, 1000);
}

void list(FieldList& f, GroupingConfig& c) {
  f.section("grouping");
  f.add("proposal_samples", c.proposal.samples, 1, 1000);
  f.add("proposal_gate_chi2", c.proposal.gate_chi2, 0.1, kMaxChi2);
  f.add("proposal_scored_points", c.proposal.scored_points, 3, 2000);
  f.add("gate_chi2", c.gate_chi2, 0.1, kMaxChi2);
  f.add("min_group_points", c.min_group_points, 3, 1000);
  f.add("max_groups", c.max_groups, 1, 64);
  f.add("reassignments", c.reassignments, 0, 20);
  f.add("smoothness_chi2", c.smoothness_chi2, 0, kMaxChi2);
  f.add("neighbors", c.neighbours, 0, 32);
  f.add("neighbor_radius_px", c.neighbour_radius_px, 1, 1000);
  f.add("known_share", c.known_share, 0, 2);
}

void list(FieldList& f, StaticGroupConfig& c) {
  f.section("static_group");
  f.add("weight_points", c.weight_points, 0, 100);
  f.add("weight_box_2d", c.weight_box_2d, 0, 100);
  f.add("weight_box_3d", c.weight_box_3d, 0, 100);
  f.add("weight_range", c.weight_range, 0, 100);
  f.add("weight_spread", c.weight_spread, 0, 100);
  f.add("weight_prediction", c.weight_prediction, 0, 100);
  f.add("weight_history", c.weight_history, 0, 100);
  f.add("spread_columns", c.spread_columns, 1, 64);
  f.add("spread_rows", c.spread_rows, 1, 64);
}

void list(FieldList& f, TwoFrameBaConfig& c) {
  f.section("two_frame_ba");
  f.add("max_iterations", c.max_iterations, 1, 100);
  f.add("robust_chi2", c.robust_chi2, 0.1, kMaxChi2);
  f.add("converged_update", c.converged_update, 1e-15, 1e-2);
  f.add("max_points", c.max_points, 3, 5000);
}

void list(FieldList& f, RepartitionConfig& c) {
  f.section("repartition");
  f.add("stay_chi2", c.stay_chi2, 0.1, kMaxChi2);
  f.add("join_chi2", c.join_chi2, 0.1, kMaxChi2);
  f.add("return_chi2", c.return_chi2, 0.1, kMaxChi2);
}

void list(FieldList& f, RayFilterConfig& c) {
  f.section("ray_filter");
  f.add("gate_sigmas", c.gate_sigmas, 0, 100);
  f.add("conclusive_chi2", c.conclusive_chi2, 0.1, kMaxChi2);
  f.add("conclusive_history", c.conclusive_history, 1, 5);
}

void list(FieldList& f, EgoMotionConfig& c) {
  f.section("ego_motion");
  f.add("min_static_points", c.min_static_points, 3, 1000);
  f.add("degraded_static_points", c.degraded_static_points, 3, 2000);
  f.add("degraded_confidence", c.degraded_confidence, 0, 1);
  f.add("min_sigma_px", c.min_sigma_px, 0.001, 10);
  f.add("max_sigma_px", c.max_sigma_px, 0.001, 10);
  f.add("start_sigma_px", c.start_sigma_px, 0.001, 10);
  f.add("sigma_learning_rate", c.sigma_learning_rate, 0, 1);
  f.add("point_gate_chi2", c.point_gate_chi2, 0.1, kMaxChi2);
  f.add("unexplained_frames", c.unexplained_frames, 1, 1000);
  f.add("window_pull", c.window_pull, 0, 1);
  f.add("max_window_error_rad", c.max_window_error_rad, 0, 4);
  f.add("lost_inflation", c.lost_inflation, 1, 1e6);
}

void list(FieldList& f, std::string_view section, BodyWindowConfig& c) {
  f.section(section);
  f.add("recent_frames", c.recent_frames, 2, 9);  // together at most kMaxWindowFrames - 1
  f.add("key_frames", c.key_frames, 1, 6);
  f.add("key_frame_spacing", c.key_frame_spacing, 1, 1000);
  f.add("key_frame_inertia", c.key_frame_inertia, 0, 1000);
  f.add("view_change_rad", c.view_change_rad, 1e-4, 10);
  f.add("max_points", c.max_points, 4, 2000);
  f.add("iterations", c.iterations, 1, 50);
  f.add("robust_chi2", c.robust_chi2, 0.1, kMaxChi2);
  f.add("acceleration_prior", c.acceleration_prior);
  f.add("sigma_acceleration_mps2", c.sigma_acceleration_mps2, 1e-4, 1000);
  f.add("sigma_acceleration_radps2", c.sigma_acceleration_radps2, 1e-4, 1000);
}

void list(FieldList& f, MembershipConfig& c) {
  f.section("membership");
  f.add("proposal_samples", c.proposal.samples, 1, 1000);
  f.add("proposal_gate_chi2", c.proposal.gate_chi2, 0.1, kMaxChi2);
  f.add("proposal_scored_points", c.proposal.scored_points, 3, 2000);
  f.add("gate_chi2", c.gate_chi2, 0.1, kMaxChi2);
  f.add("hull_margin_share", c.hull_margin_share, 0, 10);
  f.add("hull_missed_frames", c.hull_missed_frames, 0, 1000);
  f.add("min_points", c.min_points, 3, 1000);
}

void list(FieldList& f, IdentityConfig& c) {
  f.section("identity");
  f.add("gate_chi2_mean", c.gate_chi2_mean, 0.1, kMaxChi2);
  f.add("reach_share", c.reach_share, 0, 10);
  f.add("min_reach_m", c.min_reach_m, 0, 100);
  f.add("vote_chi2", c.vote_chi2, 0, kMaxChi2);
}

void list(FieldList& f, MergeConfig& c) {
  f.section("merge");
  f.add("gate_chi2", c.gate_chi2, 0.1, kMaxChi2);
  f.add("agreeing_frames", c.agreeing_frames, 1, 1000);
  f.add("touch_share", c.touch_share, 0, 10);
  f.add("min_touch_m", c.min_touch_m, 0, 100);
}

void list(FieldList& f, ReidentificationConfig& c) {
  f.section("reidentification");
  f.add("max_descriptor_distance2", c.max_descriptor_distance2, 0, 4);
  f.add("ratio2", c.ratio2, 0, 1);
  f.add("min_matches", c.min_matches, 3, 1000);
  f.add("gate_m", c.gate_m, 0, 1000);
  f.add("growth_mps", c.growth_mps, 0, 100);
  f.add("gate_chi2", c.gate_chi2, 0.1, kMaxChi2);
  f.add("samples", c.samples, 1, 10000);
  f.add("motion_px", c.motion_px, 0, 1000);
  f.add("motion_share", c.motion_share, 0, 1);
}

void list(FieldList& f, RegistryConfig& c) {
  f.section("registry");
  f.add("min_points", c.min_points, 3, 1000);
  f.add("part_reach_share", c.part_reach_share, 0, 10);
  f.add("max_static_inside", c.max_static_inside, 0, 100);
  f.add("min_spread_px", c.min_spread_px, 0, 1000);
  f.add("confirm_frames", c.confirm_frames, 1, 1000);
  f.add("confirm_points", c.confirm_points, 3, 1000);
  f.add("confirm_support", c.confirm_support, 0, 1000000);
  f.add("confirm_evidence", c.confirm_evidence, 0, 1e6);
  f.add("evidence_cap", c.evidence_cap, 0, 1e6);
  f.add("confirm_sigmas", c.confirm_sigmas, 0, 1000);
  f.add("confirm_move_px", c.confirm_move_px, 0, 1000);
  f.add("confirm_ego_share", c.confirm_ego_share, 0, 1);
  f.add("confirm_ego_frames", c.confirm_ego_frames, 1, 1000);
  f.add("tentative_patience_frames", c.tentative_patience_frames, 0, 1000);
  f.add("coast_s", c.coast_s, 0, 600);
  f.add("recover_after_s", c.recover_after_s, 0, 600);
  f.add("sigma_acceleration_mps2", c.sigma_acceleration_mps2, 1e-4, 1000);
  f.add("sigma_acceleration_radps2", c.sigma_acceleration_radps2, 1e-4, 1000);
  f.add("gap_min_m", c.clusters.min_gap_m, 0, 100);
  f.add("gap_spacings", c.clusters.gap_spacings, 0, 1000);
  f.add("gap_sigmas", c.clusters.gap_sigmas, 0, 1000);
  f.add("min_share_in_parts", c.min_share_in_parts, 0, 1);
  f.add("min_share_of_one", c.min_share_of_one, 0, 1);
  f.add("split_frames", c.split_frames, 1, 1000);
  f.add("max_model_points", c.max_model_points, 4, 512);
}

}  // namespace

std::vector<ConfigField> config_fields(PipelineConfig& config) {
  FieldList fields;
  list(fields, config.steps);
  list(fields, config.front_end);
  list(fields, config.front_end.klt);
  list(fields, config.front_end.stereo);
  list(fields, config.front_end.surf);
  list(fields, config.front_end.surf_match);
  list(fields, config.seed_points);
  list(fields, config.grouping);
  list(fields, config.static_group);
  list(fields, config.two_frame_ba);
  list(fields, config.repartition);
  list(fields, config.ray_filter);
  list(fields, config.ego_motion);
  list(fields, "static_window", config.static_window);
  list(fields, config.membership);
  list(fields, config.identity);
  list(fields, config.merge);
  list(fields, config.reidentification);
  list(fields, config.registry);
  list(fields, "object_window", config.object_window);
  return fields.take();
}

std::vector<ConfigConflict> config_conflicts(const PipelineConfig& config) {
  std::vector<ConfigConflict> conflicts;
  const auto require = [&](bool holds, std::vector<std::string> keys, const char* rule) {
    if (!holds) conflicts.push_back({std::move(keys), rule, "change one of the two"});
  };
  const StereoMatchConfig& stereo = config.front_end.stereo;
  const EgoMotionConfig& ego = config.ego_motion;
  require(config.front_end.surf.sampling_step != 3, {"surf.sampling_step_px"},
          "surf.sampling_step_px must be 1, 2 or 4");
  require(stereo.min_disparity_px < stereo.max_disparity_px, {"stereo.min_disparity_px", "stereo.max_disparity_px"},
          "stereo.min_disparity_px must be below max_disparity_px");
  require(ego.min_sigma_px <= ego.start_sigma_px && ego.start_sigma_px <= ego.max_sigma_px,
          {"ego_motion.start_sigma_px", "ego_motion.min_sigma_px", "ego_motion.max_sigma_px"},
          "ego_motion.start_sigma_px must lie between min_sigma_px and max_sigma_px");
  require(ego.min_static_points <= ego.degraded_static_points,
          {"ego_motion.min_static_points", "ego_motion.degraded_static_points"},
          "ego_motion.min_static_points must not be above degraded_static_points");
  return conflicts;
}

}  // namespace pelorus
