#include "services/preview.h"

#include <gtest/gtest.h>

#include <chrono>
#include <opencv2/imgcodecs.hpp>

namespace pelorus {
namespace {

TEST(Preview, WorstPictureStillFitsOneDatagram) {
  cv::Mat noise(800, 1024, CV_8UC3);
  cv::randu(noise, 0, 255);  // nothing compresses worse
  const PreviewPicture picture = encode_preview(noise, Timestamp{5}, 60000);
  ASSERT_FALSE(picture.jpeg.empty());
  EXPECT_LE(picture.jpeg.size(), 60000U);
  const cv::Mat decoded = cv::imdecode(picture.jpeg, cv::IMREAD_COLOR);
  EXPECT_EQ(decoded.cols, picture.width);
  EXPECT_EQ(decoded.rows, picture.height);
  EXPECT_EQ(picture.capture_time, Timestamp{5});
}

TEST(Preview, AQuietPictureKeepsItsSize) {
  const cv::Mat grey(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
  EXPECT_EQ(encode_preview(grey, Timestamp{}, 60000).width, 640);
}

TEST(Preview, PicturesComeAtTheirRateAndOnRequest) {
  Mailbox<PreviewPicture> ready;
  Wake wake;
  const StereoRig rig{320, 240, 250, 160, 120, 0.12};
  Preview preview({.rate_hz = 1, .max_bytes = 60000}, rig, ready, wake);
  Image left(320, 240);
  Publication publication;
  const auto at = [](double s) { return Timestamp{std::int64_t{1'000'000'000'000} + std::llround(s * 1e9)}; };
  ASSERT_TRUE(preview.due(at(0)));
  publication.result.capture_time = at(0);
  preview.offer(left.view(), publication, {});
  EXPECT_FALSE(preview.due(at(0.9)));
  EXPECT_TRUE(preview.due(at(1.0)));
  preview.request();
  EXPECT_TRUE(preview.due(at(0.1)));
  const PreviewPicture* picture = nullptr;
  for (int i = 0; i < 200 && picture == nullptr; ++i) {
    wake.wait(std::chrono::milliseconds(20));
    picture = ready.fetch();
  }
  ASSERT_NE(picture, nullptr);
  EXPECT_GT(picture->jpeg.size(), 500U);
  EXPECT_EQ(picture->capture_time, at(0));
}

}  // namespace
}  // namespace pelorus
