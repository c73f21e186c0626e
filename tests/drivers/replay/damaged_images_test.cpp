// What a damaged image costs: its pair, and no more.

#include <gtest/gtest.h>

#include <vector>

#include "drivers/replay/dataset.h"
#include "tests/drivers/replay/recording_fixture.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

using DamagedImages = RecordingFixture;

TEST_F(DamagedImages, ATruncatedImageIsAnErrorWithFileAndFrameAndReadingGoesOn) {
  const fs::path root = euroc();
  const fs::path broken = root / "mav0/cam1/data" / png(2);
  fs::resize_file(broken, fs::file_size(broken) / 2);
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  SourcePair pair;
  ASSERT_TRUE(source->next(pair).value());
  ASSERT_TRUE(source->next(pair).value());
  const auto failed = source->next(pair);
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.error().place, broken.string());
  EXPECT_NE(failed.error().detail.find("truncated"), std::string::npos) << failed.error().message();
  EXPECT_NE(failed.error().detail.find("frame 2"), std::string::npos) << failed.error().message();
  EXPECT_EQ(exit_code(failed.error().code), 3);
  EXPECT_EQ(all_seqs(*source), (std::vector<std::uint64_t>{3, 4, 5, 6, 7}));
}

TEST_F(DamagedImages, ADamagedFirstPairCostsItselfOnly) {
  const fs::path root = euroc();
  const fs::path first = root / "mav0/cam0/data" / png(0);
  const fs::path second = root / "mav0/cam1/data" / png(1);
  write(first, "this is no picture");
  write(second, "");
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  SourcePair pair;
  const auto undecodable = source->next(pair);
  ASSERT_FALSE(undecodable.ok());
  EXPECT_EQ(undecodable.error().place, first.string());
  EXPECT_NE(undecodable.error().detail.find("cannot be decoded"), std::string::npos) << undecodable.error().message();
  const auto empty = source->next(pair);
  ASSERT_FALSE(empty.ok());
  EXPECT_EQ(empty.error().place, second.string());
  EXPECT_NE(empty.error().detail.find("empty"), std::string::npos) << empty.error().message();
  EXPECT_EQ(all_seqs(*source), (std::vector<std::uint64_t>{2, 3, 4, 5, 6, 7}));
}

TEST_F(DamagedImages, ARecordingWithoutAReadablePairIsAnError) {
  const fs::path root = euroc();
  for (int i = 0; i < kPairs; ++i) write(root / "mav0" / (i % 2 == 0 ? "cam0" : "cam1") / "data" / png(i), "damaged");
  expect_error(root, "mav0", "none of its pairs can be read (8 tried)");
  expect_error(root, "mav0", png(0));
}

TEST_F(DamagedImages, ADamagedImageBodyIsAnError) {
  const fs::path root = euroc();
  const fs::path broken = root / "mav0/cam0/data" / png(1);
  std::string bytes(fs::file_size(broken), '\0');
  std::ifstream(broken, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  for (std::size_t i = 60; i < 90; ++i) bytes[i] = static_cast<char>(bytes[i] ^ 0x5a);
  write(broken, bytes);
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  SourcePair pair;
  ASSERT_TRUE(source->next(pair).value());
  testing::internal::CaptureStderr();
  const auto failed = source->next(pair);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "the decoder's own line names no file";
  ASSERT_FALSE(failed.ok());
  EXPECT_NE(failed.error().detail.find("cannot be decoded"), std::string::npos) << failed.error().message();
}

TEST_F(DamagedImages, SizesThatDifferFromTheOtherCameraOrTheCalibrationAreErrors) {
  const fs::path root = euroc();
  write_image(root / "mav0/cam1/data" / png(0), 5, 32, 48);
  expect_error(root, "cam1", "is 32x48, the left image 64x48");
  write_image(root / "mav0/cam0/data" / png(0), 5, 32, 48);
  expect_error(root, "cam0", "is 32x48, the calibration is for 64x48");
}

}  // namespace
}  // namespace pelorus
