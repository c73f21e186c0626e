#include "firmware-host/pelorus/doctor/can_bus.h"

namespace pelorus {
namespace {

std::string rate_text(const CanLink& link) {
  if (link.kind != "can") return link.kind + ", no bit rate";
  std::string text = std::to_string(link.bit_rate.value_or(0) / 1000) + " kbit/s";
  if (link.data_bit_rate) text += ", data " + std::to_string(*link.data_bit_rate / 1000) + " kbit/s";
  return text;
}

}  // namespace

HostCheck judge_can(const CanConfig& config, const CanLink& link) {
  HostCheck check{Verdict::ok, "CAN", "", ""};
  const std::string& name = config.interface;
  const auto judged = [&](Verdict verdict, const std::string& found, const std::string& cure) {
    check.verdict = verdict;
    check.found = found;
    check.cure = cure;
    return check;
  };
  if (!config.enabled) return judged(Verdict::ok, "not used (can.enabled: false)", "");
  if (!link.exists)
    return judged(Verdict::fail, "there is no interface " + name,
                  "load the controller's driver; ip link show type can");
  if (!link.is_can) return judged(Verdict::fail, name + " is no CAN interface", "can.interface: the name of one");
  const bool needs_rate = link.kind == "can";
  if (needs_rate && !link.bit_rate)
    return judged(Verdict::fail, name + " has no bit rate",
                  "ip link set " + name + " type can bitrate 500000 restart-ms 100 (systemd/30-can0.network)");
  if (!link.up)
    return judged(Verdict::fail, name + " is down (" + rate_text(link) + ")", "ip link set " + name + " up");
  if (config.fd && !link.fd)
    return judged(Verdict::fail, name + " takes no FD frames, can.fd asks for them",
                  "ip link set " + name + " down; ip link set " + name +
                      (needs_rate ? " type can bitrate 500000 dbitrate 2000000 fd on" : " mtu 72"));
  const std::string found =
      name + " " + to_text(link.state) + ", " + rate_text(link) + (link.fd ? ", FD" : ", classic");
  if (link.state == CanBusState::bus_off || link.state == CanBusState::passive)
    return judged(Verdict::fail, found, "wrong bit rate, cable, termination, or nobody else on the bus");
  if (link.state == CanBusState::warning) return judged(Verdict::warn, found, "look at cable and termination");
  if (needs_rate && link.restart_ms.value_or(0) == 0)
    return judged(Verdict::warn, found + ", no restart after bus-off",
                  "ip link set " + name + " type can restart-ms 100");
  return judged(Verdict::ok, found, "");
}

}  // namespace pelorus
