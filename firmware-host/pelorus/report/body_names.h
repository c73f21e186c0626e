#pragma once
// One name for each body, everywhere on the page: the number it was seen under (as in the annotated pictures) and,
// where truth knows it, its true name: "#1 crate". Pure.

#include <string>

#include "firmware-host/pelorus/report/page_data.h"

namespace pelorus {

// Of an object of the run.
[[nodiscard]] std::string object_name(const ReportInput& input, BodyId id);
// Of a true body, with every number it was seen under.
[[nodiscard]] std::string body_name(const ReportInput& input, const BodyErrors& errors);
// Beside a curve, where there is no room for every number: "#1 +19 crate" from three on.
[[nodiscard]] std::string short_body_name(const ReportInput& input, const BodyErrors& errors);
[[nodiscard]] const std::string& true_name(const ReportInput& input, const BodyErrors& errors);

}  // namespace pelorus
