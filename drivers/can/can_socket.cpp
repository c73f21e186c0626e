#include "drivers/can/can_socket.h"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

namespace pelorus {
namespace {

Error device_error(const std::string& interface, const std::string& what, const std::string& cure) {
  return Error{ErrorCode::device, interface, what + ": " + std::strerror(errno), cure};
}

template <class Value>
bool set_option(int socket, int level, int name, const Value& value) {
  return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
}

// The fewest mask filters that pass identifiers first..last: blocks of powers of two.
std::vector<can_filter> range_filters(std::uint32_t first, std::uint32_t last) {
  std::vector<can_filter> filters;
  while (first <= last) {
    std::uint32_t block = 1;
    while ((first & (2 * block - 1)) == 0 && first + 2 * block - 1 <= last) block *= 2;
    filters.push_back({first, CAN_EFF_FLAG | CAN_RTR_FLAG | (CAN_SFF_MASK & ~(block - 1))});
    first += block;
  }
  return filters;
}

bool set_filters(int socket, const CanSocketOptions& options) {
  std::vector<can_filter> filters;
  if (options.receive_data) filters = range_filters(options.first_id, std::min(options.last_id, CAN_SFF_MASK));
  const auto bytes = static_cast<socklen_t>(filters.size() * sizeof(can_filter));
  return ::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters.empty() ? nullptr : filters.data(), bytes) == 0;
}

CanSendOutcome outcome_of_error() {
  switch (errno) {
    case EAGAIN:
    case ENOBUFS:
    case EINTR:
      return CanSendOutcome::full;
    case ENETDOWN:
      return CanSendOutcome::down;
    default:
      return CanSendOutcome::gone;  // ENODEV, ENXIO: the interface was removed
  }
}

bool make_non_blocking(int socket) {
  const int flags = ::fcntl(socket, F_GETFL);
  return flags >= 0 && ::fcntl(socket, F_SETFL, flags | O_NONBLOCK) == 0;
}

// canfd_frame and can_frame share identifier, length and the place of the bytes.
static_assert(offsetof(can_frame, data) == offsetof(canfd_frame, data));
static_assert(offsetof(can_frame, can_id) == offsetof(canfd_frame, can_id));

Timestamp kernel_time(msghdr& message) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_TIMESTAMPNS) continue;
    timespec time{};
    std::memcpy(&time, CMSG_DATA(c), sizeof time);
    return Timestamp{static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec};
  }
  return {};
}

bool unpack(const canfd_frame& raw, std::size_t size, CanFrame& frame) {
  if (size != CAN_MTU && size != CANFD_MTU) return false;
  frame = CanFrame{};
  frame.fd = size == CANFD_MTU;
  if (raw.len > (frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN)) return false;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = raw.len;
  std::copy_n(raw.data, raw.len, frame.bytes.begin());
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    frame.type = CanFrameType::error;
    frame.id = raw.can_id & CAN_ERR_MASK;
  } else if ((raw.can_id & CAN_RTR_FLAG) != 0) {
    frame.type = CanFrameType::remote;
  }
  return true;
}

}  // namespace

Result<CanSocket> CanSocket::open(const CanSocketOptions& options) {
  const std::string& name = options.interface;
  if (name.empty() || name.size() >= IFNAMSIZ)
    return Error{ErrorCode::device, name, "is no name of an interface", "1 to 15 characters, such as can0"};
  UniqueFd socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket) return device_error(name, "no CAN socket", "modprobe can-raw; allow AF_CAN in the service's unit");
  ifreq request{};
  name.copy(request.ifr_name, IFNAMSIZ - 1);
  if (::ioctl(socket.get(), SIOCGIFINDEX, &request) < 0)
    return device_error(name, "no such interface", "`ip link` lists what there is");
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (options.fd) {
    if (::ioctl(socket.get(), SIOCGIFMTU, &request) < 0 || request.ifr_mtu < static_cast<int>(CANFD_MTU))
      return Error{ErrorCode::device, name, "carries no CAN FD frames", "`ip link set " + name + " up type can fd on`"};
    if (!set_option(socket.get(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, int{1}))
      return device_error(name, "no FD frames", "a kernel with CAN FD");
  }
  const can_err_mask_t errors = CAN_ERR_MASK;
  const bool set = set_filters(socket.get(), options) &&
                   set_option(socket.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) &&
                   set_option(socket.get(), SOL_SOCKET, SO_TIMESTAMPNS, int{1}) &&
                   set_option(socket.get(), SOL_SOCKET, SO_SNDBUF, options.queue_bytes / 2);  // the kernel doubles it
  if (!set) return device_error(name, "socket option refused", "");
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0)
    return device_error(name, "cannot be bound", "");
  return CanSocket(std::move(socket), options.bit_rate_switch);
}

CanSocket CanSocket::adopt(UniqueFd socket, bool bit_rate_switch) {
  // Should this fail, calls may wait: then the descriptor is none and every call says gone.
  if (!make_non_blocking(socket.get())) socket.reset();
  return CanSocket(std::move(socket), bit_rate_switch);
}

CanSendOutcome CanSocket::send(const CanFrame& frame) {
  canfd_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
  raw.len = frame.size;
  if (frame.fd && bit_rate_switch_) raw.flags = CANFD_BRS;
  std::copy_n(frame.bytes.begin(), frame.size, raw.data);
  const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  const ssize_t sent = ::send(socket_.get(), &raw, size, MSG_NOSIGNAL);
  return sent == static_cast<ssize_t>(size) ? CanSendOutcome::sent : outcome_of_error();
}

CanReceiveOutcome CanSocket::receive(CanFrame& frame) {
  canfd_frame raw{};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control{};
  iovec part{&raw, sizeof raw};
  for (;;) {
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t got = ::recvmsg(socket_.get(), &message, 0);
    if (got == 0) return CanReceiveOutcome::gone;
    if (got < 0) {
      if (errno == EINTR) continue;
      if (errno == EAGAIN) return CanReceiveOutcome::none;
      return errno == ENETDOWN ? CanReceiveOutcome::down : CanReceiveOutcome::gone;
    }
    if (!unpack(raw, static_cast<std::size_t>(got), frame)) continue;  // of a protocol we do not know
    frame.time = kernel_time(message);
    return CanReceiveOutcome::frame;
  }
}

std::optional<std::size_t> CanSocket::unsent_bytes() const {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (::getsockopt(socket_.get(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) < 0) return std::nullopt;
  return memory[SK_MEMINFO_WMEM_ALLOC];
}

}  // namespace pelorus
