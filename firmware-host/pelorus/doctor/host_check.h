#pragma once
// HostCheck: one thing that was looked at before a dive, what was found, and what to do about it. Pure.

#include <span>
#include <string>

namespace pelorus {

enum class Verdict {
  ok,
  warn,  // the service works, but worse than it could
  fail   // the dive would go wrong
};
[[nodiscard]] const char* to_text(Verdict verdict);  // "OK", "WARN", "FAIL"

struct HostCheck {
  Verdict verdict = Verdict::ok;
  std::string topic;  // a few words, unique within a checkup
  std::string found;
  std::string cure;  // empty when all is well
};

// A line per check, its cure on the line below, and a summary.
[[nodiscard]] std::string checks_text(std::span<const HostCheck> checks);
// {"checks":[{"topic","verdict","found","cure"}...],"warnings":n,"failures":n}
[[nodiscard]] std::string checks_json(std::span<const HostCheck> checks);
[[nodiscard]] int count(std::span<const HostCheck> checks, Verdict verdict);

}  // namespace pelorus
