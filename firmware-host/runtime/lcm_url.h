#pragma once
// Whether a text is an address that LCM takes. LCM itself answers a wrong one as it answers a network that is not there
// yet, which is worth waiting for. Pure.

#include <string>

namespace pelorus {

inline constexpr const char* kLcmUrlCure = "write it like udpm://239.255.76.67:7667?ttl=0";

// "provider://place?options"; of udpm, the place is a multicast group and a port, or empty for LCM's own.
[[nodiscard]] bool is_lcm_url(const std::string& url);

}  // namespace pelorus
