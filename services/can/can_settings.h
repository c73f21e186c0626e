#pragma once
// Settings of the CAN output, apart from the publisher so that reading a configuration needs none of it. Pure data.

#include <string>

#include "services/can/can_contract.h"

namespace pelorus {

struct CanConfig {
  bool enabled = false;
  std::string interface = "can0";
  bool fd = false;                                    // VIS_FD in place of the seven classic frames
  bool bit_rate_switch = true;                        // FD: payload at the data bit rate
  int base_id = static_cast<int>(kCanDefaultBaseId);  // of the twelve identifiers, docs/can.md
  int slow_every = 5;                                 // position and node frames with every n-th estimate
  double retry_ms = 1000;                             // an interface that is not there is looked for this often
};

}  // namespace pelorus
