// main() of test programs that are one test to ctest, or run where ctest does not see them: Google Test's own calls a
// program good that skipped all it had to do. 77 = nothing failed, and something was skipped; with PELORUS_NO_SKIPS set
// (where everything needed is known to be there) that is a failure.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const int failed = RUN_ALL_TESTS();
  if (failed != 0) return failed;
  const int skipped = ::testing::UnitTest::GetInstance()->skipped_test_count();
  if (skipped == 0) return 0;
  const bool forbidden = std::getenv("PELORUS_NO_SKIPS") != nullptr;
  std::printf("%s: %d tests skipped\n", forbidden ? "FAILED (PELORUS_NO_SKIPS)" : "not all done", skipped);
  return forbidden ? 1 : 77;
}
