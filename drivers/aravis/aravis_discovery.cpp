#include "drivers/aravis/aravis_discovery.h"

#include <arv.h>

namespace pelorus {
namespace {

std::string or_empty(const char* text) { return text != nullptr ? text : ""; }

}  // namespace

std::vector<FoundCamera> find_aravis_cameras() {
  arv_update_device_list();
  std::vector<FoundCamera> found;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    if (or_empty(arv_get_device_protocol(i)) != "GigEVision") continue;
    found.push_back({or_empty(arv_get_device_id(i)), or_empty(arv_get_device_address(i)),
                     or_empty(arv_get_device_vendor(i)), or_empty(arv_get_device_model(i)),
                     or_empty(arv_get_device_serial_nbr(i))});
  }
  return found;
}

}  // namespace pelorus
