#pragma once
// The page that `pelorus top` shows: a function from what was heard to lines of a given size. What is stale says so
// with its age; what is unknown is "-", never zero. Color repeats what the words say. Pure.

#include <string>
#include <vector>

#include "firmware-host/pelorus/top/bus_view.h"

namespace pelorus {

enum class PageStyle { plain, strong, good, warning, bad, faint };

struct PageSpan {
  PageStyle style = PageStyle::plain;
  std::string text;
};
using PageLine = std::vector<PageSpan>;

struct PageSize {
  int columns = 80;
  int rows = 24;
};

// At most `rows` lines of at most `columns` characters. Bodies that find no room are counted on the last line.
[[nodiscard]] std::vector<PageLine> status_page(const BusView& view, ArrivalTime now, PageSize size);

[[nodiscard]] std::string plain_text(const PageLine& line);
// With ANSI colors (ECMA-48 SGR).
[[nodiscard]] std::string colored_text(const PageLine& line);

// The same facts for scripts: one JSON object, SI units, radians; unknown numbers are null.
[[nodiscard]] std::string status_json(const BusView& view, ArrivalTime now);

}  // namespace pelorus
