#pragma once
// Lines of the page of `pelorus top`: label in front, then facts; what is too long for the screen goes on below. Pure.

#include <optional>
#include <string>
#include <vector>

#include "firmware-host/pelorus/top/status_page.h"

namespace pelorus {

inline constexpr std::size_t kLabelWidth = 9;

// "12.3 ms", or "- ms" when unknown; what rounds to zero has no sign.
[[nodiscard]] std::string number_text(double value, int decimals, const char* unit, double scale = 1);
// Filled up with blanks to `width`: the word stands at the right, or at the left.
[[nodiscard]] std::string padded_right(const std::string& word, std::size_t width);
[[nodiscard]] std::string padded_left(std::string word, std::size_t width);

// A page under construction; a stale part is faint, behind a red mark with its age.
class PageWriter {
 public:
  PageWriter(ArrivalTime now, std::size_t columns) : now_(now), columns_(columns) {}

  template <class Message>
  void part(const std::optional<Heard<Message>>& heard, double limit_s) {
    stale_ = is_stale(heard, now_, limit_s);
    age_ = heard ? "STALE " + number_text(heard->age_s(now_), 1, " s") : "NOT HEARD YET";
  }
  // Facts that do not fit go on below: a count of faults that is cut off would be as good as none.
  void line(const char* label, std::string facts, PageStyle style = PageStyle::plain);
  // `rest` stands behind the line, or below it where that is too long.
  void add_with_rest(PageLine made, const std::string& rest);
  void add(PageLine made) { lines_.push_back(std::move(made)); }
  [[nodiscard]] bool stale() const { return stale_; }
  [[nodiscard]] const std::string& age() const { return age_; }
  std::vector<PageLine> take() { return std::move(lines_); }

 private:
  ArrivalTime now_;
  std::size_t columns_;
  bool stale_ = false;
  std::string age_;
  std::vector<PageLine> lines_;
};

}  // namespace pelorus
