#include "firmware-host/runtime/log_sink.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

namespace pelorus {
namespace {

Timestamp at_s(double s) { return Timestamp{static_cast<std::int64_t>(1e18 + s * 1e9)}; }

TEST(LogSink, EveryLineInTheJournalHasItsPriority) {
  ::testing::internal::CaptureStderr();
  LogSink log(true);
  log.line(LogLevel::warning, "first\nsecond");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "<4>first\n<4>second\n");
}

TEST(LogSink, OnATerminalLinesHaveTimeAndWord) {
  ::testing::internal::CaptureStderr();
  LogSink log(false);
  log.line(LogLevel::error, "no camera");
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("error"), std::string::npos);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(text[2], ':');
}

TEST(LogSink, OneLineASecondForEachCauseAndTheRestCounted) {
  ::testing::internal::CaptureStderr();
  LogSink log(true);
  for (int i = 0; i < 10; ++i) log.limited(LogLevel::warning, "lcm", "unreachable", at_s(0.05 * i));
  log.limited(LogLevel::warning, "camera", "lost", at_s(0.5));
  log.limited(LogLevel::warning, "lcm", "unreachable", at_s(1.1));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "<4>unreachable\n<4>lost\n<4>unreachable (9 more before)\n");
}

TEST(LogSink, TheJournalIsKnownByItsStreamOnly) {
  struct stat facts {};
  ASSERT_EQ(::fstat(STDERR_FILENO, &facts), 0);
  setenv("JOURNAL_STREAM", (std::to_string(facts.st_dev) + ":" + std::to_string(facts.st_ino)).c_str(), 1);
  EXPECT_TRUE(stderr_is_journal());
  setenv("JOURNAL_STREAM", "1:2", 1);
  EXPECT_FALSE(stderr_is_journal()) << "inherited from a parent whose stderr was the journal";
  unsetenv("JOURNAL_STREAM");
  EXPECT_FALSE(stderr_is_journal());
}

}  // namespace
}  // namespace pelorus
