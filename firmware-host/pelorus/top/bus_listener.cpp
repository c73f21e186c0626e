#include "firmware-host/pelorus/top/bus_listener.h"

#include <lcm/lcm-cpp.hpp>
#include <thread>

namespace pelorus {
namespace {

constexpr std::chrono::seconds kRateWindow{3};

// LCM takes channels as regular expressions.
std::string literal(const std::string& channel) {
  std::string pattern;
  for (const char c : channel) {
    const bool word = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
    pattern += (word ? "" : "\\") + std::string(1, c);
  }
  return pattern;
}

}  // namespace

BusListener::BusListener(const std::string& url, const std::string& vehicle) : link_(url) {
  view_.url = url;
  view_.vehicle = vehicle;
}

void BusListener::subscribe(lcm::LCM& bus) {
  bus.subscribe(literal(view_.vehicle + ".VIS_ODOM"), &BusListener::take_odom, this);
  bus.subscribe(literal(view_.vehicle + ".VIS_TRACKS"), &BusListener::take_tracks, this);
  bus.subscribe(literal(view_.vehicle + ".VIS_HEALTH"), &BusListener::take_health, this);
  subscribed_ = &bus;
}

void BusListener::listen(std::chrono::milliseconds patience) {
  lcm::LCM* bus = link_.connection();
  view_.trouble = bus != nullptr ? "" : "LCM cannot be opened: no multicast route? (pelorus doctor)";
  if (bus == nullptr) {
    subscribed_ = nullptr;
    std::this_thread::sleep_for(patience);
    return;
  }
  if (bus != subscribed_) subscribe(*bus);
  // Where multicast leaves but does not come back (a firewall), LCM has no socket to wait on, and waiting would abort.
  const bool deaf = bus->getFileno() < 0;
  if (deaf) view_.trouble = "LCM hears nothing: multicast does not come back (firewall?)";
  int outcome = deaf ? -1 : bus->handleTimeout(static_cast<int>(patience.count()));
  link_.note(outcome >= 0);
  while (outcome > 0) outcome = bus->handleTimeout(0);
  const ArrivalTime now = std::chrono::steady_clock::now();
  while (!odom_arrivals_.empty() && now - odom_arrivals_.front() > kRateWindow) odom_arrivals_.pop_front();
  view_.odom_rate_hz = heard_rate_hz(odom_arrivals_, view_.odom.has_value());
}

void BusListener::take_odom(const lcm::ReceiveBuffer*, const std::string&, const vis_odom_t* message) {
  const ArrivalTime now = std::chrono::steady_clock::now();
  view_.odom = Heard<vis_odom_t>{*message, now};
  odom_arrivals_.push_back(now);
}

void BusListener::take_tracks(const lcm::ReceiveBuffer*, const std::string&, const vis_tracks_t* message) {
  view_.tracks = Heard<vis_tracks_t>{*message, std::chrono::steady_clock::now()};
}

void BusListener::take_health(const lcm::ReceiveBuffer*, const std::string&, const vis_health_t* message) {
  // Counters of another run of the service are no growth.
  const bool same_run = view_.health && view_.health->message.uptime_s < message->uptime_s;
  view_.health_before = same_run ? view_.health : std::nullopt;
  view_.health = Heard<vis_health_t>{*message, std::chrono::steady_clock::now()};
}

}  // namespace pelorus
