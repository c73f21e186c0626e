#include "drivers/aravis/gvcp_probe.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>

#include "drivers/unique_fd.h"

namespace pelorus {
namespace {

// GigE Vision 2.0, chapter 16: key, flags (acknowledge), READREG_CMD, length, request id, address 0 (version).
constexpr std::uint16_t kControlPort = 3956;
constexpr std::array<std::uint8_t, 12> kReadVersion{0x42, 0x01, 0x00, 0x80, 0x00, 0x04, 0x50, 0x4c, 0, 0, 0, 0};
constexpr std::size_t kHeader = 8;

}  // namespace

std::optional<sockaddr_in> gvcp_address(const std::string& text) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kControlPort);
  if (inet_pton(AF_INET, text.c_str(), &address.sin_addr) != 1) return std::nullopt;
  return address;
}

bool answers_gvcp(const sockaddr_in& camera, std::chrono::milliseconds patience) {
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  // The one cast that the socket interface of C asks for.
  if (!fd || ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&camera), sizeof camera) != 0) return false;
  for (int tries = 0; tries < 2; ++tries) {
    if (::send(fd.get(), kReadVersion.data(), kReadVersion.size(), 0) < 0) continue;
    pollfd readable{fd.get(), POLLIN, 0};
    std::array<std::uint8_t, 64> answer{};
    // Any acknowledgement of ours counts, a refusal too: it is there.
    if (::poll(&readable, 1, static_cast<int>(patience.count())) > 0 &&
        ::recv(fd.get(), answer.data(), answer.size(), 0) >= static_cast<ssize_t>(kHeader) &&
        answer[6] == kReadVersion[6] && answer[7] == kReadVersion[7])
      return true;
  }
  return false;
}

}  // namespace pelorus
