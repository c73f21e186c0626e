#include "firmware-host/pelorusd/exchanged_sides.h"

#include <algorithm>

#include "firmware-host/runtime/side_check.h"

namespace pelorus {
namespace {

constexpr auto kPatience = std::chrono::seconds(1);  // of LOST before the first pair is asked for
// Between two pairs, in the end: a check costs the main thread 0.1 s, and darkness lasts for hours.
constexpr auto kLongestPause = std::chrono::seconds(60);
constexpr int kPairsToBelieve = 2;
constexpr int kCopies = 3;  // of a mailbox

}  // namespace

ExchangedSides::ExchangedSides(VisionControl& control, Mailbox<SourcePair>& lost_pairs, const Rectifier& rectifier)
    : control_(control), lost_pairs_(lost_pairs), rectifier_(rectifier) {
  const StereoRig& rig = rectifier.rig();
  for (int i = 0; i < kCopies; ++i) {  // each round brings another of the copies to the writer
    lost_pairs_.draft().left.resize(rig.width, rig.height);
    lost_pairs_.draft().right.resize(rig.width, rig.height);
    (void)lost_pairs_.post();
    (void)lost_pairs_.fetch();
  }
}

bool ExchangedSides::look(VisionState state, StateReason reason, Clock::time_point now) {
  if (reason == StateReason::repeated_picture) return false;  // was not worth a step: no word of what it shows
  if (state != VisionState::lost && reason != StateReason::exchanged_sides) {
    lost_ = false;
    control_.sides_exchanged.store(false);
    return false;
  }
  if (!lost_) {
    lost_ = true;
    exchanged_ = 0;
    next_ask_ = now + kPatience;
    pause_ = kPatience;
    // What an earlier time was shown, or asked for in vain, says nothing of this one.
    control_.lost_pair_wanted.store(false);
    (void)lost_pairs_.fetch();
  }
  if (const SourcePair* pair = lost_pairs_.fetch()) return judge(*pair, now);
  if (now < next_ask_) return false;
  next_ask_ = now + pause_;
  pause_ = std::min(2 * pause_, kLongestPause);
  control_.lost_pair_wanted.store(true);
  return false;
}

bool ExchangedSides::judge(const SourcePair& pair, Clock::time_point now) {
  const Sides sides = sides_of(match_sides(pair, rectifier_));
  if (sides == Sides::unclear) return false;
  const bool known = exchanged_ >= kPairsToBelieve;
  exchanged_ = sides == Sides::exchanged ? std::min(exchanged_ + 1, kPairsToBelieve) : 0;
  const bool believed = exchanged_ == kPairsToBelieve;
  // The pair that confirms is not waited for in the pauses of darkness; what is known is asked about rarely.
  const bool to_confirm = exchanged_ > 0 && !believed;
  if (!to_confirm) pause_ = kLongestPause;
  next_ask_ = now + (to_confirm ? kPatience : kLongestPause);
  control_.sides_exchanged.store(believed);
  return believed && !known;
}

}  // namespace pelorus
