#pragma once
// Mailbox<T>: the latest value from one thread to another, neither of which ever waits. Three copies: one being
// written, one being read, one in between that the two sides exchange for theirs. A value the reader did not fetch in
// time is replaced by the next; the writer is told. Thread-safe for exactly one writer and one reader.
// O(1) plus the copy of T; allocates nothing unless T does.

#include <array>
#include <atomic>
#include <cstdint>

namespace pelorus {

template <class T>
class Mailbox {
 public:
  Mailbox() = default;
  explicit Mailbox(const T& initial) { copies_.fill({initial}); }
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  // Writer: the value to fill, then post(). It holds an old value until then.
  [[nodiscard]] T& draft() { return copies_[writing_].value; }
  // Writer: the draft becomes the latest value. True when it replaced one that nobody had fetched.
  bool post() {
    const std::uint8_t previous = middle_.exchange(std::uint8_t(writing_ | kFresh), std::memory_order_acq_rel);
    writing_ = previous & kIndex;
    return (previous & kFresh) != 0;
  }
  bool post(const T& value) {
    draft() = value;
    return post();
  }

  // Reader: the latest value when there is one that was not fetched before, else nullptr. Valid until the next call.
  [[nodiscard]] const T* fetch() {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return nullptr;
    reading_ = middle_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    return &copies_[reading_].value;
  }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;
  struct alignas(64) Copy {
    T value{};
  };
  std::array<Copy, 3> copies_{};
  std::uint8_t writing_ = 0;
  alignas(64) std::uint8_t reading_ = 1;
  alignas(64) std::atomic<std::uint8_t> middle_{2};
};

}  // namespace pelorus
