#include "firmware-host/pelorus/top/status_page.h"

namespace pelorus {
namespace {

const char* sgr(PageStyle style) {
  switch (style) {
    case PageStyle::plain:
      return "";
    case PageStyle::strong:
      return "\033[1m";
    case PageStyle::good:
      return "\033[1;32m";
    case PageStyle::warning:
      return "\033[33m";
    case PageStyle::bad:
      return "\033[1;31m";
    case PageStyle::faint:
      return "\033[2m";
  }
  return "";
}

}  // namespace

std::string plain_text(const PageLine& line) {
  std::string text;
  for (const PageSpan& span : line) text += span.text;
  return text;
}

std::string colored_text(const PageLine& line) {
  std::string text;
  for (const PageSpan& span : line) {
    const std::string start = sgr(span.style);
    text += start.empty() || span.text.empty() ? span.text : start + span.text + "\033[0m";
  }
  return text;
}

}  // namespace pelorus
