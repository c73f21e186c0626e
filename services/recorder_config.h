#pragma once
// Settings of the recorder. Pure data.

#include <string>

namespace pelorus {

struct RecorderConfig {
  std::string folder = "recordings";  // each recording is a folder in it, named by its start in UTC
  bool at_start = false;              // record from the start; else by command only
  std::string format = "png";         // png, or pgm: larger, but costs no computing
  double min_free_gb = 2;             // of the disk; below it recording stops until there is room again
  int every = 1;                      // of so many pairs one is recorded
  int queue_pairs = 12;               // waiting for the disk, in memory
};

}  // namespace pelorus
