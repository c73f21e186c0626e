#pragma once
// write_page: the page's template (report/web, built into this program) with the data of one run, as one file that
// needs nothing else. Written under another name first: the page is there whole or not at all. Thread-bound.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "firmware-host/pelorus/report/page_data.h"

namespace pelorus {

// Beyond this a page is slow to open and does not pass through mail: less of the scene is embedded instead.
inline constexpr std::size_t kLargestPage = 5'000'000;  // bytes

// Empty in a program that was built without the page (PELORUS_WITH_REPORT=OFF).
[[nodiscard]] std::string_view page_template();

// The template with the data in its place. Data may hold any text: it cannot end the element that holds it.
[[nodiscard]] Result<std::string> filled_page(std::string_view page, const std::string& data);

[[nodiscard]] Result<Ok> write_page(const std::filesystem::path& file, const ReportInput& input,
                                    std::size_t largest = kLargestPage);

}  // namespace pelorus
