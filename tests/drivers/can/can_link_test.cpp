#include "drivers/can/can_link.h"

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>

#include <cstring>
#include <vector>

namespace pelorus {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <class Value>
Bytes bytes_of(const Value& value) {
  Bytes bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

// One by one: GCC 12 warns falsely on insert() here.
void append(Bytes& list, const Bytes& more) {
  for (const std::uint8_t byte : more) list.push_back(byte);
}

Bytes attribute(unsigned short type, const Bytes& payload) {
  Bytes bytes = bytes_of(rtattr{static_cast<unsigned short>(RTA_LENGTH(payload.size())), type});
  append(bytes, payload);
  bytes.resize(RTA_ALIGN(bytes.size()));
  return bytes;
}

Bytes text(const char* word) { return Bytes(word, word + std::strlen(word) + 1); }

// An answer of the kernel about one interface.
Bytes link_message(unsigned short type, unsigned flags, const Bytes& attributes) {
  ifinfomsg info{};
  info.ifi_type = type;
  info.ifi_flags = flags;
  nlmsghdr head{};
  head.nlmsg_type = RTM_NEWLINK;
  head.nlmsg_len = static_cast<std::uint32_t>(NLMSG_SPACE(sizeof info) + attributes.size());
  Bytes message = bytes_of(head);
  append(message, bytes_of(info));
  message.resize(NLMSG_SPACE(sizeof info));
  append(message, attributes);
  return message;
}

Bytes controller(std::uint32_t state) {
  can_bittiming slow{}, fast{};
  slow.bitrate = 500000;
  fast.bitrate = 2000000;
  Bytes data = attribute(IFLA_CAN_BITTIMING, bytes_of(slow));
  append(data, attribute(IFLA_CAN_STATE, bytes_of(state)));
  append(data, attribute(IFLA_CAN_RESTART_MS, bytes_of(std::uint32_t{100})));
  append(data, attribute(IFLA_CAN_DATA_BITTIMING, bytes_of(fast)));
  Bytes info = attribute(IFLA_INFO_KIND, text("can"));
  append(info, attribute(IFLA_INFO_DATA, data));
  Bytes all = attribute(IFLA_IFNAME, text("can0"));
  append(all, attribute(IFLA_MTU, bytes_of(std::uint32_t{CANFD_MTU})));
  append(all, attribute(IFLA_LINKINFO, info));
  return all;
}

TEST(CanLink, RatesFormatRestartAndStateAreRead) {
  const CanLink link = parse_can_link(link_message(ARPHRD_CAN, IFF_UP, controller(CAN_STATE_ERROR_PASSIVE)));
  EXPECT_TRUE(link.exists && link.is_can && link.up && link.fd);
  EXPECT_EQ(link.kind, "can");
  EXPECT_EQ(link.bit_rate, 500000U);
  EXPECT_EQ(link.data_bit_rate, 2000000U);
  EXPECT_EQ(link.restart_ms, 100U);
  EXPECT_EQ(link.state, CanBusState::passive);
  const CanLink down = parse_can_link(link_message(ARPHRD_CAN, 0, controller(CAN_STATE_STOPPED)));
  EXPECT_FALSE(down.up);
  EXPECT_EQ(down.state, CanBusState::down);
}

TEST(CanLink, AMessageCutShortAnywhereIsReadAsFarAsItGoes) {
  const Bytes whole = link_message(ARPHRD_CAN, IFF_UP, controller(CAN_STATE_ERROR_ACTIVE));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(parse_can_link(part).exists) << size;  // the header tells a longer message
    if (size < sizeof(nlmsghdr)) continue;
    const auto told = static_cast<std::uint32_t>(size);
    std::memcpy(part.data(), &told, sizeof told);
    EXPECT_FALSE(parse_can_link(part).data_bit_rate.has_value()) << size;  // the last of all
  }
  EXPECT_TRUE(parse_can_link(whole).data_bit_rate.has_value());
}

TEST(CanLink, TheKernelTellsOtherInterfacesApart) {
  EXPECT_FALSE(read_can_link("nobody0").exists);
  const CanLink loopback = read_can_link("lo");
  EXPECT_TRUE(loopback.exists);
  EXPECT_FALSE(loopback.is_can);
}

}  // namespace
}  // namespace pelorus
