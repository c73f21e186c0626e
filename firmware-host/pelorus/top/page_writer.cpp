#include "firmware-host/pelorus/top/page_writer.h"

#include <cmath>

#include "firmware-host/pelorus/formatted.h"

namespace pelorus {
namespace {

// Takes from `rest` what fits into `room`, up to a gap between two facts, else to a blank; all of it without either.
std::string take_what_fits(std::string& rest, std::size_t room) {
  std::size_t end = std::string::npos;
  if (rest.size() > room) {
    end = rest.rfind("  ", room);
    if (end == std::string::npos) end = rest.rfind(' ', room);
  }
  const std::string taken = rest.substr(0, end);
  rest.erase(0, end == std::string::npos ? end : rest.find_first_not_of(' ', end));
  return taken;
}

}  // namespace

std::string number_text(double value, int decimals, const char* unit, double scale) {
  if (!std::isfinite(value)) return std::string("-") + unit;
  const double digit = std::pow(10.0, decimals);
  return formatted("%.*f", decimals, std::round(value * scale * digit) / digit + 0.0) + unit;
}

std::string padded_right(const std::string& word, std::size_t width) {
  return word.size() < width ? std::string(width - word.size(), ' ') + word : word;
}

std::string padded_left(std::string word, std::size_t width) {
  if (word.size() < width) word.append(width - word.size(), ' ');
  return word;
}

void PageWriter::line(const char* label, std::string facts, PageStyle style) {
  PageLine made{{PageStyle::strong, padded_left(label, kLabelWidth)}};
  std::size_t used = kLabelWidth;
  if (stale_) made.push_back({PageStyle::bad, age_ + "  "});
  if (stale_) used += age_.size() + 2;
  do {
    made.push_back({stale_ ? PageStyle::faint : style, take_what_fits(facts, columns_ > used ? columns_ - used : 0)});
    lines_.push_back(std::move(made));
    made = {{PageStyle::strong, padded_left("", kLabelWidth)}};
    used = kLabelWidth;
  } while (!facts.empty());
}

void PageWriter::add_with_rest(PageLine made, const std::string& rest) {
  const PageStyle style = stale_ ? PageStyle::faint : PageStyle::plain;
  if (plain_text(made).size() + 3 + rest.size() <= columns_) {
    made.push_back({style, "   " + rest});
    return add(std::move(made));
  }
  add(std::move(made));
  add({{PageStyle::strong, padded_left("", kLabelWidth)}, {style, rest}});
}

}  // namespace pelorus
