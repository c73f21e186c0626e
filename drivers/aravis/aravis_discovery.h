#pragma once
// The GigE Vision cameras that answer on this machine's networks. Takes about a second (Aravis waits for answers).
// Not thread-safe.

#include <string>
#include <vector>

namespace pelorus {

struct FoundCamera {
  std::string id;  // Aravis' name for it
  std::string address;
  std::string vendor;
  std::string model;
  std::string serial;
};

[[nodiscard]] std::vector<FoundCamera> find_aravis_cameras();

}  // namespace pelorus
