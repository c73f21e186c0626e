#pragma once
// What a folder of recorded frames holds, whatever its layout: per camera a list of images with time stamps; and how
// the two lists become pairs. Pure.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/time.h"
#include "core/geometry/stereo_calibration.h"
#include "drivers/stereo_source.h"

namespace pelorus {

struct RecordedImage {
  std::int64_t index = 0;  // running number within the recording
  Timestamp time;
  std::filesystem::path file;  // empty: listed, but not there
};

struct Recording {
  std::string format;
  std::filesystem::path folder;
  std::vector<RecordedImage> left;  // all that there should be, strictly increasing in time
  std::vector<RecordedImage> right;
  std::vector<std::string> remarks;  // what a user must know about the listing
  std::string listed_in;             // the files that list the images; empty: what is there is all
  // Deferred, because a user's calibration may replace it.
  std::function<Result<LoadedCalibration>()> read_calibration;
};

struct RecordedPair {
  std::uint64_t seq = 0;
  Timestamp time;  // of the left image
  std::filesystem::path left;
  std::filesystem::path right;
};

struct Pairing {
  std::vector<RecordedPair> pairs;
  std::int64_t period_ns = 0;   // nominal: median of the intervals; 0 for a single image
  std::size_t lost_left = 0;    // pairs lost because the left image is missing
  std::size_t lost_right = 0;   // ... the right one
  std::size_t lost_both = 0;    // ... or both: listed without images, or seen as a step in time
  Timestamp first_lost;         // of the image whose partner is missing, or one period after the pair before
  std::size_t longest_gap = 0;  // pairs lost in a row
  Timestamp longest_gap_after;  // time stamp of the pair before that gap
};

// Images of the two cameras belong together when their times differ by less than a quarter of the period (and
// 5 ms). seq counts nominal periods, so that every lost pair is a gap in it. An Error when nothing pairs up.
[[nodiscard]] Result<Pairing> pair_images(const Recording& recording);

// The list goes on where no image of either camera is: so it is when somebody kept the first part of a recording and
// the list whole.
[[nodiscard]] bool is_cut_short(const Recording& recording);

// What a user has to do about times that do not increase; it depends on where the times stand.
struct OrderCure {
  std::string duplicate;
  std::string earlier;
};

// The pairs lost before the last of the first `passed` pairs; when these are all, those lost after them too.
[[nodiscard]] MissingPairs missing_among(const Pairing& pairing, std::size_t passed);

// Refuses unsorted and duplicate times. `place(i)` names the file and line of image i.
[[nodiscard]] Result<> check_order(const std::vector<RecordedImage>& images, const OrderCure& cure,
                                   const std::function<std::string(std::size_t)>& place);

// The number of the first pair that `decode` can read: calibration and sizes are judged by it, since a damaged image
// costs its own pair only. An Error, of the first pair, when none of `count` pairs can be read.
[[nodiscard]] Result<std::size_t> find_readable(std::size_t count, const std::string& place,
                                                const std::function<Result<>(std::size_t)>& decode);

// Empties the name of each file that is not there (its pair is lost). An Error when none is left.
[[nodiscard]] Result<> mark_absent(std::vector<RecordedImage>& images, const std::filesystem::path& folder);

}  // namespace pelorus
