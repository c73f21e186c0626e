#include "firmware-host/pelorus/report/page.h"

namespace pelorus {

std::string_view page_template() { return {}; }

}  // namespace pelorus
