#include "firmware-host/pelorusd/progress_watch.h"

#include <algorithm>

namespace pelorus {

void ProgressWatch::look(const std::string& part, std::uint64_t count, bool excused, Clock::time_point now,
                         std::optional<std::chrono::milliseconds> longest_standstill) {
  const auto known = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == part; });
  if (known == parts_.end()) {
    parts_.push_back({part, count, now, longest_standstill.value_or(longest_)});
    return;
  }
  if (known->count != count || excused) known->moved = now;
  known->count = count;
}

std::string ProgressWatch::stuck(Clock::time_point now) const {
  for (const Part& part : parts_) {
    if (now - part.moved > part.longest) return part.name;
  }
  return "";
}

}  // namespace pelorus
