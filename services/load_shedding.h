#pragma once
// LoadShedding: how much optional work a step leaves out so that its result is ready when it is due (ARCHITECTURE,
// threads and latency): new points first, then the objects' windows; frames last of all. Pure.

#include "core/base/time.h"
#include "core/model/stage_data.h"

namespace pelorus {

class LoadShedding {
 public:
  // `left`: from now until the result is due.
  [[nodiscard]] Shed choose(Duration left) const;
  // What a step took that left out `shed` and looked for new points or not.
  void learn(Shed shed, bool refilled, Duration took);

 private:
  // What a step may take again: peaks that fade in every step, also while it is being left out, since otherwise one
  // stall would keep it out for ever.
  Duration with_refill_{};
  Duration without_refill_{};
};

}  // namespace pelorus
