#include "firmware-host/runtime/reserved_memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string>

namespace pelorus {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kPages = 1024;

long faults_of_writing(char* memory) {
  rusage before{};
  rusage after{};
  ::getrusage(RUSAGE_THREAD, &before);
  for (std::size_t page = 0; page < kPages; ++page) static_cast<volatile char*>(memory)[page * kPage] = 1;
  ::getrusage(RUSAGE_THREAD, &after);
  return after.ru_minflt - before.ru_minflt;
}

TEST(ReservedMemory, WritingWhatWasReservedFaultsNoMore) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer keeps books on each page in memory of its own";
#endif
  const std::unique_ptr<char[]> fresh(new char[kPages * kPage]);
  ASSERT_GT(faults_of_writing(fresh.get()), 0);  // or nothing is shown
  const std::unique_ptr<char[]> reserved(new char[kPages * kPage]);
  const std::string refusal = populate_reserved_memory();
  if (refusal == std::strerror(EINVAL)) GTEST_SKIP() << "this kernel cannot populate memory (Linux 5.14)";
  ASSERT_EQ(refusal, "");
  EXPECT_EQ(faults_of_writing(reserved.get()), 0);
}

}  // namespace
}  // namespace pelorus
