#include "drivers/can/can_link.h"

#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <vector>

#include "drivers/unique_fd.h"

namespace pelorus {
namespace {

using Bytes = std::span<const std::uint8_t>;

// A value at the front of the bytes; zero when they are too few.
template <class Value>
Value front(Bytes bytes) {
  Value value{};
  if (bytes.size() >= sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::string text_of(Bytes bytes) {
  std::string text(bytes.begin(), bytes.end());
  return text.substr(0, text.find('\0'));
}

// Calls take(type, payload) for each attribute of a list (rtnetlink(7)).
template <class Take>
void for_each_attribute(Bytes list, const Take& take) {
  while (list.size() >= sizeof(rtattr)) {
    const auto head = front<rtattr>(list);
    if (head.rta_len < sizeof(rtattr) || head.rta_len > list.size()) return;
    take(head.rta_type & NLA_TYPE_MASK, list.subspan(RTA_LENGTH(0), head.rta_len - RTA_LENGTH(0)));
    list = list.subspan(std::min<std::size_t>(RTA_ALIGN(head.rta_len), list.size()));
  }
}

CanBusState state_of(std::uint32_t controller) {
  switch (controller) {
    case CAN_STATE_ERROR_ACTIVE:
      return CanBusState::active;
    case CAN_STATE_ERROR_WARNING:
      return CanBusState::warning;
    case CAN_STATE_ERROR_PASSIVE:
      return CanBusState::passive;
    case CAN_STATE_BUS_OFF:
      return CanBusState::bus_off;
    default:
      return CanBusState::down;
  }
}

void take_controller(Bytes attributes, CanLink& link) {
  for_each_attribute(attributes, [&](int type, Bytes payload) {
    if (type == IFLA_CAN_BITTIMING) link.bit_rate = front<can_bittiming>(payload).bitrate;
    if (type == IFLA_CAN_DATA_BITTIMING) link.data_bit_rate = front<can_bittiming>(payload).bitrate;
    if (type == IFLA_CAN_RESTART_MS) link.restart_ms = front<std::uint32_t>(payload);
    if (type == IFLA_CAN_STATE && link.up) link.state = state_of(front<std::uint32_t>(payload));
  });
  if (link.bit_rate == 0U) link.bit_rate.reset();
  if (link.data_bit_rate == 0U) link.data_bit_rate.reset();
}

void take_link_info(Bytes attributes, CanLink& link) {
  Bytes controller;
  for_each_attribute(attributes, [&](int type, Bytes payload) {
    if (type == IFLA_INFO_KIND) link.kind = text_of(payload);
    if (type == IFLA_INFO_DATA) controller = payload;
  });
  if (link.kind == "can") take_controller(controller, link);
}

std::vector<std::uint8_t> ask_kernel(unsigned index) {
  struct {
    nlmsghdr head;
    ifinfomsg link;
  } question{};
  question.head.nlmsg_len = sizeof question;
  question.head.nlmsg_type = RTM_GETLINK;
  question.head.nlmsg_flags = NLM_F_REQUEST;
  question.link.ifi_index = static_cast<int>(index);
  const UniqueFd fd(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (!fd || ::send(fd.get(), &question, sizeof question, 0) < 0) return {};
  std::vector<std::uint8_t> answer(32768);
  const ssize_t size = ::recv(fd.get(), answer.data(), answer.size(), 0);
  answer.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return answer;
}

}  // namespace

CanLink parse_can_link(Bytes message) {
  const auto head = front<nlmsghdr>(message);
  if (head.nlmsg_type != RTM_NEWLINK || head.nlmsg_len > message.size() ||
      head.nlmsg_len < NLMSG_LENGTH(sizeof(ifinfomsg)))
    return {};
  message = message.first(head.nlmsg_len);
  const auto info = front<ifinfomsg>(message.subspan(NLMSG_HDRLEN));
  CanLink link;
  link.exists = true;
  link.is_can = info.ifi_type == ARPHRD_CAN;
  link.up = (info.ifi_flags & IFF_UP) != 0;
  link.state = link.up ? CanBusState::active : CanBusState::down;
  for_each_attribute(message.subspan(NLMSG_SPACE(sizeof(ifinfomsg))), [&](int type, Bytes payload) {
    // The size of a frame is the kernel's own mark of an interface that takes FD frames.
    if (type == IFLA_MTU) link.fd = link.is_can && front<std::uint32_t>(payload) == CANFD_MTU;
    if (type == IFLA_LINKINFO && link.is_can) take_link_info(payload, link);
  });
  return link;
}

CanLink read_can_link(const std::string& interface) {
  const unsigned index = ::if_nametoindex(interface.c_str());
  return index == 0 ? CanLink{} : parse_can_link(ask_kernel(index));
}

}  // namespace pelorus
