#pragma once
// Strong identifiers: a point's track can never be passed where a body's identity is meant.

#include <compare>
#include <cstdint>

namespace pelorus {

// A point followed from frame to frame; never reused within a run. 0 = none.
struct TrackId {
  std::uint64_t value = 0;
  auto operator<=>(const TrackId&) const = default;
};

// A rigid body. kWorldBody is the static scene; moving objects count from 1; never reused within a run.
struct BodyId {
  std::int32_t value = -1;
  auto operator<=>(const BodyId&) const = default;
};

inline constexpr BodyId kNoBody{-1};  // not (yet) explained by any body's motion
inline constexpr BodyId kWorldBody{0};

}  // namespace pelorus
