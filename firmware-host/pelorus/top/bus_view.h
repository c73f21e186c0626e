#pragma once
// BusView: the last of what was heard on the service's channels, with the moment it was heard. Pure data, and what
// follows from it. Times of arrival are this computer's, so that the clock of another one cannot make old news fresh.

#include <chrono>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <pelorus/vis_health_t.hpp>
#include <pelorus/vis_odom_t.hpp>
#include <pelorus/vis_tracks_t.hpp>
#include <string>

namespace pelorus {

using ArrivalTime = std::chrono::steady_clock::time_point;

template <class Message>
struct Heard {
  Message message;
  ArrivalTime at;
  [[nodiscard]] double age_s(ArrivalTime now) const { return std::chrono::duration<double>(now - at).count(); }
};

struct BusView {
  std::string vehicle;
  std::string url;
  std::string trouble;  // why nothing can be heard at all; empty = the bus is open
  std::optional<Heard<vis_odom_t>> odom;
  std::optional<Heard<vis_tracks_t>> tracks;
  std::optional<Heard<vis_health_t>> health;
  std::optional<Heard<vis_health_t>> health_before;                // the one before, to tell what has grown
  double odom_rate_hz = std::numeric_limits<double>::quiet_NaN();  // as heard over the last seconds; NaN: unknown

  [[nodiscard]] bool complete() const { return odom && tracks && health; }
};

inline constexpr double kStalePairs_s = 1;   // results come with each pair, silence is told by the service itself
inline constexpr double kStaleHealth_s = 3;  // once a second

template <class Message>
[[nodiscard]] bool is_stale(const std::optional<Heard<Message>>& heard, ArrivalTime now, double limit_s) {
  return !heard || heard->age_s(now) > limit_s;
}

// What `arrivals` of the last seconds say. One message is no rate yet; none after the first is one: silence.
[[nodiscard]] double heard_rate_hz(const std::deque<ArrivalTime>& arrivals, bool heard_before);

// How fast the range from the vehicle to the body shrinks [m/s]; NaN when either motion is unknown, or when the two
// messages are of different pairs.
[[nodiscard]] double closing_speed_mps(const vis_track_t& track, const vis_tracks_t& tracks, const vis_odom_t& odom);

// Where the body is as seen from the vehicle [rad]: bearing to starboard, elevation upwards.
struct Direction {
  double bearing_rad = 0;
  double elevation_rad = 0;
};
[[nodiscard]] Direction direction_of(const vis_track_t& track);

// Roll, pitch, yaw [rad] of the vehicle in the world.
struct Attitude {
  double roll_rad = 0;
  double pitch_rad = 0;
  double yaw_rad = 0;
};
[[nodiscard]] Attitude attitude_of(const vis_odom_t& odom);

}  // namespace pelorus
