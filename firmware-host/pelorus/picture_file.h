#pragma once
// Pictures that a verb writes where the user says: PNG, under a temporary name until they are whole. Thread-bound.

#include <filesystem>
#include <opencv2/core.hpp>

#include "core/base/result.h"

namespace pelorus {

// Whether `path` can become a picture, with the cure if not: for asking before the work whose picture it is.
[[nodiscard]] Result<> check_picture_name(const std::filesystem::path& path);

// Replaces a picture that is there.
[[nodiscard]] Result<> write_picture(const std::filesystem::path& path, const cv::Mat& picture);

}  // namespace pelorus
