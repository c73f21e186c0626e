#pragma once
// What is set in a GigE Vision camera before it streams, and what its chunk data tells of each frame. Thread-bound to
// the capture thread; every call is a conversation with the camera (about a millisecond each, more when it is gone).

#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "drivers/aravis/aravis_config.h"
#include "drivers/aravis/gobject_ptr.h"

namespace pelorus {

// Errors name the setting and what the camera answered.
[[nodiscard]] Result<> apply_aravis_settings(ArvCamera* camera, const AravisConfig& config);

// State of the camera's PTP, as it names it ("Slave"); empty when it has none.
[[nodiscard]] std::string ptp_status(ArvCamera* camera);

// Time stamp and exposure in the chunk data of each frame, where the camera offers them.
class AravisChunks {
 public:
  // Switches the chunks on; does nothing for cameras without.
  void enable(ArvCamera* camera);
  [[nodiscard]] bool has_time() const { return has_time_; }
  [[nodiscard]] bool has_exposure() const { return has_exposure_; }
  [[nodiscard]] std::optional<std::int64_t> time_ns(ArvBuffer* buffer) const;
  [[nodiscard]] std::optional<double> exposure_us(ArvBuffer* buffer) const;

 private:
  GObjectPtr<ArvChunkParser> parser_;
  bool has_time_ = false;
  bool has_exposure_ = false;
  double ns_per_tick_ = 1;
};

}  // namespace pelorus
