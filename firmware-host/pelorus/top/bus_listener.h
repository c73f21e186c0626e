#pragma once
// BusListener: hears the service's channels and keeps the last of each in a BusView. A bus that cannot be opened is
// tried again once a second and told in the view. Thread-bound.

#include <chrono>
#include <deque>
#include <string>

#include "firmware-host/pelorus/top/bus_view.h"
#include "services/lcm_link.h"

namespace lcm {
struct ReceiveBuffer;
}

namespace pelorus {

class BusListener {
 public:
  BusListener(const std::string& url, const std::string& vehicle);

  // Takes what comes within `patience`; returns as soon as something came, and all that waited with it.
  void listen(std::chrono::milliseconds patience);
  [[nodiscard]] const BusView& view() const { return view_; }

 private:
  void subscribe(lcm::LCM& bus);
  void take_odom(const lcm::ReceiveBuffer*, const std::string&, const vis_odom_t* message);
  void take_tracks(const lcm::ReceiveBuffer*, const std::string&, const vis_tracks_t* message);
  void take_health(const lcm::ReceiveBuffer*, const std::string&, const vis_health_t* message);

  LcmLink link_;
  const lcm::LCM* subscribed_ = nullptr;
  BusView view_;
  std::deque<ArrivalTime> odom_arrivals_;
};

}  // namespace pelorus
