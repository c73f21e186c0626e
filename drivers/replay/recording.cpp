#include "drivers/replay/recording.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

namespace pelorus {
namespace {

constexpr std::int64_t kMaxSkew_ns = 5'000'000;  // a vehicle at 1 m/s moves 5 mm: the pair is still one scene

std::int64_t median_interval_ns(const std::vector<RecordedImage>& images) {
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 1; i < images.size(); ++i) intervals.push_back(images[i].time.ns - images[i - 1].time.ns);
  if (intervals.empty()) return 0;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

// Nominal periods between two events, at least one: clocks jitter, images do not coincide.
std::uint64_t periods_between(Timestamp earlier, Timestamp later, std::int64_t period_ns) {
  if (period_ns <= 0) return 1;
  const double periods = static_cast<double>(later.ns - earlier.ns) / static_cast<double>(period_ns);
  return static_cast<std::uint64_t>(std::max(1.0, std::round(periods)));
}

std::size_t count_present(const std::vector<RecordedImage>& images) {
  return static_cast<std::size_t>(
      std::count_if(images.begin(), images.end(), [](const RecordedImage& image) { return !image.file.empty(); }));
}

// Walks both lists in time order; each step is an instant at which there should be a pair, and advances seq.
class Pairer {
 public:
  Pairer(const Recording& recording, Pairing& out) : recording_(recording), out_(out) {
    tolerance_ns_ = std::min(out.period_ns / 4, kMaxSkew_ns);
  }

  void run() {
    const RecordedImage* left = recording_.left.data();
    const RecordedImage* const left_end = left + recording_.left.size();
    const RecordedImage* right = recording_.right.data();
    const RecordedImage* const right_end = right + recording_.right.size();
    while (left != left_end || right != right_end) {
      const std::int64_t skew_ns = left == left_end     ? kNever_ns  // the right one is alone
                                   : right == right_end ? -kNever_ns
                                                        : left->time.ns - right->time.ns;
      const bool together = std::abs(skew_ns) <= tolerance_ns_;
      const RecordedImage* const now_left = together || skew_ns < 0 ? left++ : nullptr;
      const RecordedImage* const now_right = together || skew_ns > 0 ? right++ : nullptr;
      instant(now_left, now_right);
    }
  }

 private:
  static constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();

  // At least one of the two is listed.
  void instant(const RecordedImage* left, const RecordedImage* right) {
    const Timestamp time = left != nullptr ? left->time : right->time;
    advance(time);
    const bool has_left = left != nullptr && !left->file.empty();
    const bool has_right = right != nullptr && !right->file.empty();
    if (has_left && has_right) return pair(*left, *right);
    note_loss(time);
    ++(has_left ? out_.lost_right : has_right ? out_.lost_left : out_.lost_both);
  }

  void advance(Timestamp time) {
    if (any_) {
      const std::uint64_t step = periods_between(last_, time, out_.period_ns);
      seq_ += step;
      if (step > 1) note_loss(Timestamp{last_.ns + out_.period_ns});
      out_.lost_both += static_cast<std::size_t>(step - 1);
    }
    any_ = true;
    last_ = time;
  }

  void note_loss(Timestamp time) {
    if (out_.lost_left + out_.lost_right + out_.lost_both == 0) out_.first_lost = time;
  }

  void pair(const RecordedImage& left, const RecordedImage& right) {
    if (!out_.pairs.empty()) {
      const auto gap = static_cast<std::size_t>(seq_ - out_.pairs.back().seq - 1);
      if (gap > out_.longest_gap) {
        out_.longest_gap = gap;
        out_.longest_gap_after = out_.pairs.back().time;
      }
    }
    out_.pairs.push_back({seq_, left.time, left.file, right.file});
  }

  const Recording& recording_;
  Pairing& out_;
  std::int64_t tolerance_ns_ = 0;
  std::uint64_t seq_ = 0;
  Timestamp last_;
  bool any_ = false;
};

}  // namespace

Result<Pairing> pair_images(const Recording& recording) {
  Pairing out;
  // The camera with more images knows the period better.
  out.period_ns =
      median_interval_ns(recording.left.size() >= recording.right.size() ? recording.left : recording.right);
  Pairer(recording, out).run();
  if (!out.pairs.empty()) return out;
  return Error{ErrorCode::bad_input, recording.folder.string(),
               "no left image (" + std::to_string(count_present(recording.left)) + ") has a right one (" +
                   std::to_string(count_present(recording.right)) + ") of its time",
               "the cameras' time stamps must agree to 5 ms and a quarter of the frame period"};
}

bool is_cut_short(const Recording& recording) {
  std::int64_t listed_ns = 0;
  std::int64_t present_ns = 0;
  for (const auto* images : {&recording.left, &recording.right}) {
    for (const RecordedImage& image : *images) {
      listed_ns = std::max(listed_ns, image.time.ns);
      if (!image.file.empty()) present_ns = std::max(present_ns, image.time.ns);
    }
  }
  return listed_ns - kMaxSkew_ns > present_ns;
}

MissingPairs missing_among(const Pairing& pairing, std::size_t passed) {
  if (passed == 0) return {};
  const std::uint64_t lost = passed == pairing.pairs.size() ? pairing.lost_left + pairing.lost_right + pairing.lost_both
                                                            : pairing.pairs[passed - 1].seq + 1 - passed;
  return {lost, pairing.first_lost};
}

Result<> check_order(const std::vector<RecordedImage>& images, const OrderCure& cure,
                     const std::function<std::string(std::size_t)>& place) {
  for (std::size_t i = 1; i < images.size(); ++i) {
    if (images[i - 1].time < images[i].time) continue;
    const bool duplicate = images[i - 1].time == images[i].time;
    return Error{ErrorCode::bad_input, place(i),
                 "time stamp " + std::to_string(images[i].time.ns) + " ns " +
                     (duplicate ? "appears twice" : "is earlier than the one before it"),
                 duplicate ? cure.duplicate : cure.earlier};
  }
  return Ok{};
}

Result<std::size_t> find_readable(std::size_t count, const std::string& place,
                                  const std::function<Result<>(std::size_t)>& decode) {
  std::optional<Error> first;
  for (std::size_t i = 0; i < count; ++i) {
    const Result<> decoded = decode(i);
    if (decoded) return i;
    if (!first) first = decoded.error();
  }
  return Error{ErrorCode::bad_input, place,
               "none of its pairs can be read (" + std::to_string(count) + " tried)" +
                   (first ? "; the first: " + first->place + " " + first->detail : ""),
               "copy the recording again from where it was made"};
}

Result<> mark_absent(std::vector<RecordedImage>& images, const std::filesystem::path& folder) {
  for (RecordedImage& image : images) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(image.file, ignored)) image.file.clear();
  }
  if (count_present(images) > 0) return Ok{};
  return Error{
      ErrorCode::bad_input, folder.string(),
      images.empty() ? "holds no images" : "none of the " + std::to_string(images.size()) + " listed images is there",
      "copy the images of this camera, or pass the folder that holds them"};
}

}  // namespace pelorus
