#include "firmware-host/runtime/config_fields.h"

namespace pelorus {
namespace {

void add_steps(std::vector<ConfigField>& fields, MethodSteps& s) {
  const auto add = [&](std::string_view key, bool& value) { fields.push_back({"steps", key, &value}); };
  add("rigidity_grouping", s.rigidity_grouping);
  add("motion_reassignment", s.motion_reassignment);
  add("static_criteria", s.static_criteria);
  add("bundle_adjustment", s.bundle_adjustment);
  add("repartition", s.repartition);
  add("net_filter", s.net_filter);
  add("ray_filter", s.ray_filter);
  add("hull_membership", s.hull_membership);
  add("identity_mismatch", s.identity_mismatch);
  add("merge_split", s.merge_split);
  add("object_window", s.object_window);
  add("static_window", s.static_window);
  add("reidentification", s.reidentification);
  add("object_refill", s.object_refill);
  add("motion_prediction", s.motion_prediction);
}

}  // namespace

std::vector<ConfigField> config_fields(PipelineConfig& config) {
  std::vector<ConfigField> fields;
  add_steps(fields, config.steps);
  return fields;
}

}  // namespace pelorus
