#pragma once
// The log format of can-utils (candump -l, -L; canplayer): one frame a line,
//   (1700000000.050000) can0 120#7E2E04D2FFC80007      classic; #R remote
//   (1700000000.050000) can0 12B##1<hex>               FD, one digit of flags
// An identifier of eight digits is extended; one with the error flag (0x20000000) is an error frame. Pure.

#include <string>
#include <string_view>

#include "core/base/result.h"
#include "drivers/can/can_frame.h"

namespace pelorus {

struct CandumpEntry {
  CanFrame frame;
  std::string interface;
};

// One line without its newline. Errors: bad_input, the place left to the caller.
[[nodiscard]] Result<CandumpEntry> parse_candump_line(std::string_view line);

[[nodiscard]] std::string candump_line(const CanFrame& frame, std::string_view interface);

}  // namespace pelorus
