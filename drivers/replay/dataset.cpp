#include "drivers/replay/dataset.h"

#include "drivers/replay/euroc.h"
#include "drivers/replay/image_file.h"
#include "drivers/replay/kitti.h"
#include "drivers/replay/lcm_event_file.h"
#include "drivers/replay/lcm_log.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBridgedGap = 3;  // pairs; longer gaps are worth a line to the user

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

class RecordedSource final : public StereoSource {
 public:
  RecordedSource(Recording recording, Pairing pairing, LoadedCalibration calibration)
      : recording_(std::move(recording)), pairing_(std::move(pairing)), calibration_(std::move(calibration)) {}

  // Looks at the first pair that can be decoded: a wrong calibration is found before any work is done.
  Result<> probe() {
    SourcePair pair;
    const auto found = find_readable(pairing_.pairs.size(), recording_.folder.string(),
                                     [&](std::size_t i) { return decode(pairing_.pairs[i], pair); });
    if (!found) return found.error();
    for (CameraIntrinsics* camera : {&calibration_.calibration.left, &calibration_.calibration.right}) {
      if (camera->width != 0) continue;
      camera->width = pair.left.width();
      camera->height = pair.left.height();
    }
    if (auto sizes = check_sizes(pairing_.pairs[found.value()], pair); !sizes) return sizes;
    return check_calibration(calibration_.calibration, calibration_.origin);
  }

  const StereoCalibration& calibration() const override { return calibration_.calibration; }
  std::size_t pair_count() const override { return pairing_.pairs.size(); }

  Result<bool> next(SourcePair& pair) override {
    if (next_ == pairing_.pairs.size()) return false;
    const RecordedPair& recorded = pairing_.pairs[next_++];
    pair.seq = recorded.seq;
    pair.capture_time = recorded.time;
    if (auto decoded = decode(recorded, pair); !decoded) return in_frame(decoded.error(), recorded);
    if (auto sizes = check_sizes(recorded, pair); !sizes) return in_frame(sizes.error(), recorded);
    return true;
  }

  MissingPairs missing_pairs() const override { return missing_among(pairing_, next_); }

  std::string description() const override {
    std::string text = recording_.format + " " + recording_.folder.string() + ": " + pairs_text(pairing_.pairs.size());
    if (pairing_.period_ns > 0) text += ", " + std::to_string(pairing_.period_ns / 1'000'000) + " ms apart";
    text += "\ncalibration: " + calibration_.origin;
    for (const std::string& assumption : calibration_.assumptions) text += "\nassumed: " + assumption;
    for (const std::string& remark : recording_.remarks) text += "\nnote: " + remark;
    const std::size_t lost = pairing_.lost_left + pairing_.lost_right + pairing_.lost_both;
    if (lost > 0)
      text += "\nlost: " + pairs_text(lost) + " (" + std::to_string(pairing_.lost_left) + " without left image, " +
              std::to_string(pairing_.lost_right) + " without right image, " + std::to_string(pairing_.lost_both) +
              " without both), the first at " + std::to_string(pairing_.first_lost.ns) + " ns";
    if (pairing_.longest_gap > kBridgedGap)
      text += "\nwarning: " + std::to_string(pairing_.longest_gap) + " pairs in a row are lost after " +
              std::to_string(pairing_.longest_gap_after.ns) + " ns; motion over such a gap is a guess";
    return text;
  }

 private:
  Result<> decode(const RecordedPair& recorded, SourcePair& pair) {
    if (auto left = file_.read(recorded.left, pair.left); !left) return left;
    return file_.read(recorded.right, pair.right);
  }

  static Error in_frame(Error error, const RecordedPair& recorded) {
    error.detail += ", frame " + std::to_string(recorded.seq);
    return error;
  }

  Result<> check_sizes(const RecordedPair& recorded, const SourcePair& pair) const {
    if (pair.left.width() != pair.right.width() || pair.left.height() != pair.right.height())
      return Error{ErrorCode::bad_input, recorded.right.string(),
                   "is " + size_text(pair.right.width(), pair.right.height()) + ", the left image " +
                       size_text(pair.left.width(), pair.left.height()),
                   "both cameras must record the same size"};
    const CameraIntrinsics& camera = calibration_.calibration.left;
    if (pair.left.width() != camera.width || pair.left.height() != camera.height)
      return Error{ErrorCode::bad_input, recorded.left.string(),
                   "is " + size_text(pair.left.width(), pair.left.height()) + ", the calibration is for " +
                       size_text(camera.width, camera.height),
                   "use the calibration of this recording (" + calibration_.origin + " was used)"};
    return Ok{};
  }

  Recording recording_;
  Pairing pairing_;
  LoadedCalibration calibration_;
  ImageFile file_;
  std::size_t next_ = 0;
};

// The user's calibration, completed by what only the data set knows, or the data set's own.
Result<LoadedCalibration> choose_calibration(const Recording& recording,
                                             const std::optional<LoadedCalibration>& given) {
  if (!given) {
    auto own = recording.read_calibration();
    if (own) return own;
    Error error = own.error();
    error.cure += (error.cure.empty() ? "" : "; or ") +
                  std::string("name another calibration: --calib FILE, or source.calibration of the service");
    return error;
  }
  LoadedCalibration out = *given;
  if (auto checked = check_calibration(out.calibration, out.origin); !checked) return checked.error();
  if (out.calibration.body_known) return out;
  // A data set without a readable calibration is the very reason to pass one: no error here.
  if (const auto own = recording.read_calibration(); own.ok() && own.value().calibration.body_known) {
    out.calibration.T_body_left = own.value().calibration.T_body_left;
    out.calibration.body_known = true;
    out.assumptions.push_back("the left camera's place on the body is the data set's");
  }
  return out;
}

}  // namespace

Result<Recording> list_recording(const fs::path& path) {
  std::error_code failed;
  const std::string place = path.string();
  if (!fs::exists(path, failed)) return Error{ErrorCode::bad_input, place, "does not exist", "check the path"};
  if (!fs::is_directory(path, failed))
    return Error{ErrorCode::bad_input, place, "is neither a folder nor an LCM log",
                 "pass the folder of the recording, or a log written by lcm-logger"};
  if (fs::is_empty(path, failed))
    return Error{ErrorCode::bad_input, place, "the folder is empty", "pass the folder of the recording"};
  if (failed) return Error{ErrorCode::io, place, "cannot be listed: " + failed.message(), "check its permissions"};
  if (const fs::path mav0 = find_euroc(path); !mav0.empty()) return list_euroc(mav0);
  if (is_kitti_raw(path)) return list_kitti_raw(path);
  if (is_kitti_odometry(path)) return list_kitti_odometry(path);
  return Error{ErrorCode::bad_input, place, "is no known data set",
               "expected EuRoC (mav0/cam0, mav0/cam1), KITTI odometry (image_0, image_1, times.txt), KITTI raw "
               "(image_00/data, image_01/data) or the file of an LCM log"};
}

Result<std::unique_ptr<StereoSource>> open_dataset(const fs::path& path,
                                                   const std::optional<LoadedCalibration>& given) {
  if (LcmEventFile::is_log(path)) return open_lcm_log(path, given);
  auto recording = list_recording(path);
  if (!recording) return recording.error();
  auto calibration = choose_calibration(recording.value(), given);
  if (!calibration) return calibration.error();
  auto pairing = pair_images(recording.value());
  if (!pairing) return pairing.error();
  if (is_cut_short(recording.value())) {
    const std::string& list = recording.value().listed_in;
    recording.value().remarks.push_back("the pairs at the end of " + list +
                                        " are not there; if the recording was cut on purpose, cut that list too");
  }
  auto source = std::make_unique<RecordedSource>(std::move(recording.value()), std::move(pairing.value()),
                                                 std::move(calibration.value()));
  if (auto first = source->probe(); !first) return first.error();
  return std::unique_ptr<StereoSource>(std::move(source));
}

}  // namespace pelorus
