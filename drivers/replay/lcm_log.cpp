#include "drivers/replay/lcm_log.h"

#include "drivers/replay/image_file.h"
#include "drivers/replay/lcm_event_file.h"
#include "drivers/replay/recording.h"

namespace pelorus {
namespace {

// First eight bytes of a bot_core.images_t, made by lcm-gen from names and types of its fields.
constexpr std::int64_t kImagesType = 0x20ba4f05e8f5e33a;
constexpr std::int64_t kLeft = 0, kRight = 1;  // image_types
constexpr std::int64_t kGray = 1497715271;     // FourCC 'GREY'
constexpr std::int64_t kJpeg = 1196444237;     // FourCC 'MJPG'
constexpr std::int64_t kMostImages = 16;       // in one message

// A picture inside a message.
struct LoggedImage {
  std::int64_t width = 0, height = 0, row_stride = 0, format = 0, size = 0;
  const std::uint8_t* data = nullptr;
};

LoggedImage read_image(LcmReader& reader) {
  LoggedImage image;
  (void)reader.whole(8);  // utime, that of the message counts
  image.width = reader.whole(4);
  image.height = reader.whole(4);
  image.row_stride = reader.whole(4);
  image.format = reader.whole(4);
  image.size = reader.whole(4);
  image.data = reader.bytes(image.size);
  for (std::int64_t left = reader.whole(4); left > 0 && reader.ok(); --left) {
    (void)reader.bytes(reader.whole(4));  // key
    (void)reader.bytes(reader.whole(4));  // value
  }
  return image;
}

struct LoggedPair {
  std::int64_t utime = 0;
  LoggedImage left, right;  // data nullptr: not in the message
};

bool read_pair(const std::vector<std::uint8_t>& data, LoggedPair& pair) {
  LcmReader reader(data.data(), data.size());
  if (reader.whole(8) != kImagesType) return false;
  pair.utime = reader.whole(8);
  const std::int64_t count = reader.whole(4);
  if (count < 0 || count > kMostImages) return false;
  std::int64_t types[kMostImages] = {};
  for (std::int64_t i = 0; i < count; ++i) types[i] = reader.whole(2);
  for (std::int64_t i = 0; i < count; ++i) {
    const LoggedImage image = read_image(reader);
    if (types[i] == kLeft) pair.left = image;
    if (types[i] == kRight) pair.right = image;
  }
  return reader.ok() && pair.left.data != nullptr && pair.right.data != nullptr;
}

class LcmLogSource final : public StereoSource {
 public:
  LcmLogSource(std::string path, LcmEventFile file) : path_(std::move(path)), file_(std::move(file)) {}

  // Lists the pairs; nothing is decoded.
  Result<> list() {
    Recording recording;
    recording.folder = path_;
    LcmEvent event;
    std::vector<std::uint8_t> data;
    while (file_.next(event)) {
      if (!channel_.empty() && event.channel != channel_) continue;
      LoggedPair pair;
      // The type first: most events of a log are something else.
      if (!file_.read(event, data, 8) || LcmReader(data.data(), data.size()).whole(8) != kImagesType) continue;
      if (!file_.read(event, data) || !read_pair(data, pair)) continue;
      channel_ = event.channel;
      const RecordedImage image{static_cast<std::int64_t>(events_.size()), Timestamp{pair.utime * 1000}, path_};
      recording.left.push_back(image);
      recording.right.push_back(image);
      events_.push_back(event);
    }
    if (events_.empty()) {
      return Error{ErrorCode::bad_input, path_, "holds no bot_core.images_t with a left and a right picture",
                   "log the channel of the stereo camera"};
    }
    const auto place = [this](std::size_t i) { return path_ + ", pair " + std::to_string(i); };
    const std::string cure = "log one camera once, with its capture times as utime";
    if (Result<> order = check_order(recording.left, {cure, cure}, place); !order) return order;
    Result<Pairing> pairing = pair_images(recording);
    if (!pairing) return pairing.error();
    pairing_ = std::move(pairing.value());
    return Ok{};
  }

  Result<> calibrate(const LoadedCalibration& calibration) {
    calibration_ = calibration;
    SourcePair first;
    const auto found = find_readable(events_.size(), path_, [&](std::size_t i) { return decode(i, first); });
    if (!found) return found.error();
    for (CameraIntrinsics* camera : {&calibration_.calibration.left, &calibration_.calibration.right}) {
      if (camera->width != 0) continue;
      camera->width = first.left.width();
      camera->height = first.left.height();
    }
    if (Result<> sizes = check_sizes(found.value(), first); !sizes) return sizes;
    return check_calibration(calibration_.calibration, calibration_.origin);
  }

  [[nodiscard]] const StereoCalibration& calibration() const override { return calibration_.calibration; }
  [[nodiscard]] std::size_t pair_count() const override { return events_.size(); }
  [[nodiscard]] Result<bool> next(SourcePair& pair) override {
    if (next_ == events_.size()) return false;
    const std::size_t index = next_++;
    if (Result<> decoded = decode(index, pair); !decoded) return decoded.error();
    if (Result<> sizes = check_sizes(index, pair); !sizes) return sizes.error();
    return true;
  }
  [[nodiscard]] MissingPairs missing_pairs() const override { return missing_among(pairing_, next_); }
  [[nodiscard]] std::string description() const override {
    std::string text = "LCM log " + path_ + ", channel " + channel_ + ": " + pairs_text(events_.size());
    if (pairing_.period_ns > 0) text += ", " + std::to_string(pairing_.period_ns / 1'000'000) + " ms apart";
    text += "\ncalibration: " + calibration_.origin;
    for (const std::string& assumption : calibration_.assumptions) text += "\nassumed: " + assumption;
    if (pairing_.lost_both > 0) text += "\nlost: " + pairs_text(pairing_.lost_both) + " (never logged)";
    if (file_.skipped_bytes() > 0) text += "\nnote: " + std::to_string(file_.skipped_bytes()) + " broken bytes skipped";
    return text;
  }

 private:
  [[nodiscard]] Error in_pair(std::size_t index, const std::string& what) const {
    return {ErrorCode::bad_input, path_ + ", pair " + std::to_string(index), what, "a broken message costs its pair"};
  }

  Result<> decode(std::size_t index, SourcePair& pair) {
    LoggedPair logged;
    if (!file_.read(events_[index], data_) || !read_pair(data_, logged)) return in_pair(index, "cannot be read");
    pair.seq = pairing_.pairs[index].seq;
    pair.capture_time = pairing_.pairs[index].time;
    if (Result<> left = decode_image(index, logged.left, pair.left); !left) return left;
    return decode_image(index, logged.right, pair.right);
  }

  Result<> decode_image(std::size_t index, const LoggedImage& image, Image& out) {
    if (image.format == kJpeg) {
      jpeg_.assign(image.data, image.data + image.size);
      return decode_picture(jpeg_, path_ + ", pair " + std::to_string(index), out);
    }
    const bool gray = image.format == kGray && image.width > 0 && image.height > 0 && image.row_stride >= image.width &&
                      image.size >= (image.height - 1) * image.row_stride + image.width;
    if (!gray)
      return in_pair(index, "is neither 8-bit gray nor JPEG (pixelformat " + std::to_string(image.format) + ")");
    out.assign({image.data, static_cast<int>(image.width), static_cast<int>(image.height),
                static_cast<std::ptrdiff_t>(image.row_stride)});
    return Ok{};
  }

  Result<> check_sizes(std::size_t index, const SourcePair& pair) const {
    const CameraIntrinsics& camera = calibration_.calibration.left;
    for (const Image* image : {&pair.left, &pair.right}) {
      if (image->width() == camera.width && image->height() == camera.height) continue;
      return in_pair(index, "is " + std::to_string(image->width()) + "x" + std::to_string(image->height()) +
                                ", the calibration is for " + std::to_string(camera.width) + "x" +
                                std::to_string(camera.height));
    }
    return Ok{};
  }

  std::string path_;
  LcmEventFile file_;
  std::string channel_;
  std::vector<LcmEvent> events_;
  Pairing pairing_;
  LoadedCalibration calibration_;
  std::vector<std::uint8_t> data_;
  std::vector<std::uint8_t> jpeg_;
  std::size_t next_ = 0;
};

}  // namespace

Result<std::unique_ptr<StereoSource>> open_lcm_log(const std::filesystem::path& path,
                                                   const std::optional<LoadedCalibration>& calibration) {
  if (!calibration) {
    return Error{ErrorCode::bad_calibration, path.string(), "an LCM log brings no calibration",
                 "name the file of this pair of cameras (--calib, or source.calibration)"};
  }
  Result<LcmEventFile> file = LcmEventFile::open(path);
  if (!file) return file.error();
  auto source = std::make_unique<LcmLogSource>(path.string(), std::move(file.value()));
  if (Result<> listed = source->list(); !listed) return listed.error();
  if (Result<> calibrated = source->calibrate(*calibration); !calibrated) return calibrated.error();
  return std::unique_ptr<StereoSource>(std::move(source));
}

}  // namespace pelorus
