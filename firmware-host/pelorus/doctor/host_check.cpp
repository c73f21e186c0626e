#include "firmware-host/pelorus/doctor/host_check.h"

#include <algorithm>
#include <vector>

#include "firmware-host/pelorus/json_object.h"

namespace pelorus {
namespace {

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

}  // namespace

const char* to_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
      return "OK";
    case Verdict::warn:
      return "WARN";
    case Verdict::fail:
      return "FAIL";
  }
  return "?";
}

int count(std::span<const HostCheck> checks, Verdict verdict) {
  return static_cast<int>(
      std::count_if(checks.begin(), checks.end(), [&](const HostCheck& check) { return check.verdict == verdict; }));
}

std::string checks_text(std::span<const HostCheck> checks) {
  std::size_t widest = 0;
  for (const HostCheck& check : checks) widest = std::max(widest, check.topic.size());
  std::string text;
  for (const HostCheck& check : checks) {
    text += padded(to_text(check.verdict), 6) + padded(check.topic, widest + 2) + check.found + "\n";
    if (!check.cure.empty()) text += std::string(6 + widest + 2, ' ') + "-> " + check.cure + "\n";
  }
  const int failures = count(checks, Verdict::fail), warnings = count(checks, Verdict::warn);
  text += std::to_string(checks.size()) + " checks, " + std::to_string(warnings) + " WARN, " +
          std::to_string(failures) + " FAIL" + (failures > 0 ? ": not ready to dive\n" : "\n");
  return text;
}

std::string checks_json(std::span<const HostCheck> checks) {
  std::vector<std::string> rows;
  for (const HostCheck& check : checks) {
    rows.push_back(JsonObject()
                       .text("topic", check.topic)
                       .text("verdict", to_text(check.verdict))
                       .text("found", check.found)
                       .text("cure", check.cure)
                       .str());
  }
  return JsonObject()
      .raw("checks", json_array(rows))
      .integer("warnings", count(checks, Verdict::warn))
      .integer("failures", count(checks, Verdict::fail))
      .str();
}

}  // namespace pelorus
