// What test_main.cpp makes of a program by its exit code; run by skips_check.sh.
#include <gtest/gtest.h>

TEST(SkipsCheck, Passes) {}
TEST(SkipsCheck, Skips) { GTEST_SKIP() << "as it should"; }
TEST(SkipsCheck, Fails) { FAIL() << "as it should"; }
