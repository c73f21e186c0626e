#include "core/base/mailbox.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace pelorus {
namespace {

TEST(Mailbox, GivesEachValueAtMostOnce) {
  Mailbox<int> box;
  EXPECT_EQ(box.fetch(), nullptr);
  EXPECT_FALSE(box.post(7));
  const int* got = box.fetch();
  ASSERT_NE(got, nullptr);
  EXPECT_EQ(*got, 7);
  EXPECT_EQ(box.fetch(), nullptr);
}

TEST(Mailbox, TellsTheWriterWhatNobodyFetched) {
  Mailbox<int> box;
  EXPECT_FALSE(box.post(1));
  EXPECT_TRUE(box.post(2));
  EXPECT_EQ(*box.fetch(), 2);
  EXPECT_FALSE(box.post(3));
}

TEST(Mailbox, TheFetchedValueStaysWhileTheWriterGoesOn) {
  Mailbox<int> box;
  box.post(1);
  const int* held = box.fetch();
  for (int i = 2; i < 9; ++i) {
    box.post(i);
    EXPECT_EQ(*held, 1);
  }
}

// Every value seen is whole and newer than the one before; what was not seen was reported as replaced.
TEST(Mailbox, NeverTearsAValueBetweenThreads) {
  using Block = std::array<long, 32>;
  Mailbox<Block> box;
  constexpr long kPosts = 100'000;
  long replaced = 0;
  std::jthread writer([&] {
    for (long i = 1; i <= kPosts; ++i) {
      box.draft().fill(i);
      replaced += box.post() ? 1 : 0;
    }
  });
  long fetched = 0;
  for (long last = 0; last < kPosts;) {
    const Block* block = box.fetch();
    if (block == nullptr) continue;
    ++fetched;
    ASSERT_GT(block->front(), last);
    last = block->front();
    for (const long value : *block) ASSERT_EQ(value, last);
  }
  writer.join();
  EXPECT_EQ(fetched + replaced, kPosts);
}

}  // namespace
}  // namespace pelorus
