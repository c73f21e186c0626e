#include "firmware-host/runtime/lcm_url.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "services/lcm_address.h"

namespace pelorus {
namespace {

constexpr std::array<std::string_view, 5> kProviders{"udpm", "mpudpm", "tcpq", "memq", "file"};  // of liblcm

}  // namespace

bool is_lcm_url(const std::string& url) {
  const std::size_t mark = url.find("://");
  if (mark == std::string::npos) return false;
  const std::string provider = url.substr(0, mark);
  if (std::find(kProviders.begin(), kProviders.end(), provider) == kProviders.end()) return false;
  return provider != "udpm" || parse_lcm_url(url).has_value();
}

}  // namespace pelorus
