#include "firmware-host/runtime/lcm_url.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace pelorus {
namespace {

constexpr std::array<std::string_view, 5> kProviders{"udpm", "mpudpm", "tcpq", "memq", "file"};  // of liblcm

bool is_port(const std::string& text) {
  int port = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, port);
  return error == std::errc{} && rest == end && port > 0 && port <= 65535;
}

bool is_multicast_place(const std::string& place) {
  const std::size_t colon = place.find(':');
  in_addr group{};
  return inet_pton(AF_INET, place.substr(0, colon).c_str(), &group) == 1 && IN_MULTICAST(ntohl(group.s_addr)) &&
         (colon == std::string::npos || is_port(place.substr(colon + 1)));
}

}  // namespace

bool is_lcm_url(const std::string& url) {
  const std::size_t mark = url.find("://");
  if (mark == std::string::npos) return false;
  const std::string provider = url.substr(0, mark);
  if (std::find(kProviders.begin(), kProviders.end(), provider) == kProviders.end()) return false;
  const std::string place = url.substr(mark + 3, url.find('?', mark) - mark - 3);
  return provider != "udpm" || place.empty() || is_multicast_place(place);
}

}  // namespace pelorus
