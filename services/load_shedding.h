#pragma once
// LoadShedding: how much optional work a step leaves out so that its result is ready when it is due (ARCHITECTURE,
// threads and latency): detection first, then refinement, then the objects' windows; frames last of all. Pure.

#include "core/base/time.h"
#include "core/pipeline/pipeline.h"

namespace pelorus {

class LoadShedding {
 public:
  // `left`: from now until the result is due.
  [[nodiscard]] Shed choose(Duration left) const;
  // What a step took that left out `shed` and looked for new points or not.
  void learn(Shed shed, bool refilled, Duration took);

 private:
  // Peaks that fade over some fifty steps: what a step may take again.
  Duration with_refill_{};
  Duration without_refill_{};
};

}  // namespace pelorus
