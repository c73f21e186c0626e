#include "firmware-host/pelorus/report/page.h"

#include "firmware-host/runtime/partial_file.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDataMark = "\"PELORUS_RUN_DATA\"";
constexpr int kHalvings = 6;

}  // namespace

Result<std::string> filled_page(std::string_view page, const std::string& data) {
  if (page.empty()) {
    return Error{ErrorCode::unsupported, "report", "this program was built without the report page",
                 "install nodejs and npm, configure with -DPELORUS_WITH_REPORT=ON and build again"};
  }
  const std::size_t mark = page.find(kDataMark);
  if (mark == std::string_view::npos || page.find(kDataMark, mark + 1) != std::string_view::npos) {
    return Error{ErrorCode::unsupported, "report", "the built-in page has not exactly one place for its data",
                 "build again from clean sources"};
  }
  std::string filled(page.substr(0, mark));
  filled.reserve(page.size() + data.size() + data.size() / 100);
  for (const char c : data) {
    // "</script>" or "<!--" in a name would end or change the element.
    if (c == '<') {
      filled += "\\u003c";
    } else {
      filled += c;
    }
  }
  filled += page.substr(mark + kDataMark.size());
  return filled;
}

Result<Ok> write_page(const fs::path& file, const ReportInput& input, std::size_t largest) {
  PageBudget budget;
  for (int halving = 0;; ++halving) {
    Result<std::string> page = filled_page(page_template(), page_data(input, budget));
    if (!page) return page.error();
    if (page.value().size() <= largest || halving == kHalvings) {
      return write_together({{file, std::move(page.value())}}, true);
    }
    budget = budget.halved();
  }
}

}  // namespace pelorus
