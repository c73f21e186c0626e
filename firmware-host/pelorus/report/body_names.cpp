#include "firmware-host/pelorus/report/body_names.h"

#include <set>

namespace pelorus {
namespace {

std::set<BodyId> ids_of(const BodyErrors& errors) {
  std::set<BodyId> ids;
  for (const ErrorSample& sample : errors.samples) ids.insert(sample.object);
  return ids;
}

std::string number_of(BodyId id) { return "#" + std::to_string(id.value); }

}  // namespace

std::string object_name(const ReportInput& input, BodyId id) {
  std::string name = number_of(id);
  for (const BodyErrors& errors : input.errors.bodies) {
    if (ids_of(errors).contains(id)) name += " " + true_name(input, errors);
  }
  return name;
}

std::string body_name(const ReportInput& input, const BodyErrors& errors) {
  std::string name;
  for (const BodyId id : ids_of(errors)) name += number_of(id) + " ";
  return name + true_name(input, errors);
}

std::string short_body_name(const ReportInput& input, const BodyErrors& errors) {
  const std::set<BodyId> ids = ids_of(errors);
  if (ids.size() <= 2) return body_name(input, errors);
  return number_of(*ids.begin()) + " +" + std::to_string(ids.size() - 1) + " " + true_name(input, errors);
}

const std::string& true_name(const ReportInput& input, const BodyErrors& errors) {
  return input.judged.truth->bodies[static_cast<std::size_t>(errors.body)];
}

}  // namespace pelorus
