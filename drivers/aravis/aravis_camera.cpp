#include "drivers/aravis/aravis_camera.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "drivers/aravis/aravis_settings.h"
#include "drivers/aravis/gvcp_probe.h"
#include "drivers/pixel_format.h"

namespace pelorus {
namespace {

constexpr std::int64_t kLongestWaitNs = 5'000'000'000;

PixelFormat pixel_format(ArvPixelFormat format) {
  switch (format) {
    case ARV_PIXEL_FORMAT_MONO_8:
      return PixelFormat::gray8;
    case ARV_PIXEL_FORMAT_MONO_10:
      return PixelFormat::gray10;
    case ARV_PIXEL_FORMAT_MONO_12:
      return PixelFormat::gray12;
    case ARV_PIXEL_FORMAT_MONO_16:
      return PixelFormat::gray16;
    case ARV_PIXEL_FORMAT_BAYER_GR_8:
    case ARV_PIXEL_FORMAT_BAYER_RG_8:
    case ARV_PIXEL_FORMAT_BAYER_GB_8:
    case ARV_PIXEL_FORMAT_BAYER_BG_8:
      return PixelFormat::bayer8;
    case ARV_PIXEL_FORMAT_YUV_422_PACKED:
      return PixelFormat::uyvy;
    case ARV_PIXEL_FORMAT_YUV_422_YUYV_PACKED:
      return PixelFormat::yuyv;
    default:
      return PixelFormat::unknown;
  }
}

// The picture in a complete buffer; without bytes when its size is not the one the stream was opened for.
RawPicture picture_of(ArvBuffer* buffer, const FrameFormat& format) {
  RawPicture picture;
  std::size_t size = 0;
  const void* bytes = arv_buffer_get_image_data(buffer, &size);
  picture.width = arv_buffer_get_image_width(buffer);
  picture.height = arv_buffer_get_image_height(buffer);
  const ArvPixelFormat pixel = arv_buffer_get_image_pixel_format(buffer);
  picture.format = pixel_format(pixel);
  gint x_padding = 0;
  gint y_padding = 0;
  arv_buffer_get_image_padding(buffer, &x_padding, &y_padding);
  picture.stride = static_cast<std::ptrdiff_t>(picture.width) *
                       static_cast<std::ptrdiff_t>(ARV_PIXEL_FORMAT_BIT_PER_PIXEL(pixel) / 8) +
                   x_padding;
  if (picture.width != format.width || picture.height != format.height) return {};
  picture.bytes = static_cast<const std::uint8_t*>(bytes);
  picture.size = size;
  return picture;
}

}  // namespace

struct AravisCamera::Session {
  GObjectPtr<ArvCamera> camera;
  GObjectPtr<ArvStream> stream;  // destroyed first
  AravisChunks chunks;
  Duration exposure{};
  std::atomic<bool> control_lost{false};  // set by Aravis' heartbeat thread
  gulong signal = 0;
  CameraStatistics before;  // transport counters of the connections before this one

  [[nodiscard]] bool answers() const;
  static void on_control_lost(ArvDevice*, gpointer session) { static_cast<Session*>(session)->control_lost = true; }
  ~Session() {
    stream.reset();
    if (camera && signal != 0) g_signal_handler_disconnect(arv_camera_get_device(camera.get()), signal);
  }
};

bool AravisCamera::Session::answers() const {
  GSocketAddress* address = arv_gv_device_get_device_address(ARV_GV_DEVICE(arv_camera_get_device(camera.get())));
  sockaddr_in native{};
  if (address == nullptr || g_socket_address_to_native(address, &native, sizeof native, nullptr) == 0) return true;
  return answers_gvcp(native);
}

AravisCamera::AravisCamera(const AravisConfig& config, const CaptureClock& clock)
    : config_(config), clock_(clock), device_clock_(config.clock) {}

AravisCamera::~AravisCamera() { stop(); }

Error AravisCamera::problem(const std::string& what, const std::string& cure) const {
  return {ErrorCode::device, "camera " + config_.device, what, cure};
}

Result<> AravisCamera::open() {
  stop();
  GFailure failure;
  const char* cure = "check power, cable and address; `pelorus doctor` lists the cameras that answer";
  if (const auto address = gvcp_address(config_.device); address && !answers_gvcp(*address)) {
    return problem("does not answer", cure);
  }
  auto session = std::make_unique<Session>();
  session->camera.reset(arv_camera_new(config_.device.c_str(), failure.slot()));
  if (!session->camera) {
    return problem("cannot be opened: " + failure.message(), cure);
  }
  ArvCamera* camera = session->camera.get();
  if (arv_camera_is_gv_device(camera) == 0) return problem("is no GigE Vision camera", "use the v4l2 driver");
  // A session that was broken off may have left it running, and a running camera refuses most settings.
  arv_camera_stop_acquisition(camera, failure.slot());
  if (Result<> applied = apply_aravis_settings(camera, config_); !applied) return applied;
  session->chunks.enable(camera);
  session->signal = g_signal_connect(arv_camera_get_device(camera), "control-lost",
                                     G_CALLBACK(&Session::on_control_lost), session.get());
  session->before = statistics();
  session_ = std::move(session);
  device_clock_.reset();
  frame_ids_.restart();
  counters_.opened.add();
  return read_back();
}

// What the camera really does, whatever was asked of it.
Result<> AravisCamera::read_back() {
  ArvCamera* camera = session_->camera.get();
  GFailure failure;
  gint x = 0;
  gint y = 0;
  arv_camera_get_region(camera, &x, &y, &format_.width, &format_.height, failure.slot());
  if (failure) return problem("does not tell the size of its picture: " + failure.message(), "");
  if (config_.width_px > 0 && (format_.width != config_.width_px || format_.height != config_.height_px)) {
    return problem("sends " + std::to_string(format_.width) + "x" + std::to_string(format_.height) +
                       " where another size was asked for",
                   "set a size the camera offers");
  }
  const PixelFormat pixels = pixel_format(arv_camera_get_pixel_format(camera, failure.slot()));
  if (failure || pixels == PixelFormat::unknown) {
    return problem("sends pixels of a kind that cannot be converted (" + config_.pixel_format + ")",
                   "use Mono8, Mono10, Mono12, Mono16, Bayer..8 or YUV422");
  }
  const double exposure_us = arv_camera_get_exposure_time(camera, failure.slot());
  if (!failure) session_->exposure = Duration(std::llround(exposure_us * 1000));
  const double rate_hz = arv_camera_get_frame_rate(camera, failure.slot());
  rate_hz_ = config_.rate_hz > 0 || failure ? config_.rate_hz : rate_hz;
  const std::string ptp = config_.clock == DeviceClockKind::ptp ? ptp_status(camera) : "";
  description_ = "GigE Vision " + config_.device + ", " + std::to_string(format_.width) + "x" +
                 std::to_string(format_.height) + " " + std::string(text(pixels)) + ", packets of " +
                 std::to_string(arv_camera_gv_get_packet_size(camera, nullptr)) + " bytes, time by " +
                 (session_->chunks.has_time() ? "chunk data" : "frame leader") + (ptp.empty() ? "" : ", PTP " + ptp);
  return Ok{};
}

Result<> AravisCamera::start() {
  ArvCamera* camera = session_->camera.get();
  GFailure failure;
  const guint payload = arv_camera_get_payload(camera, failure.slot());
  if (failure || payload == 0) return problem("does not tell the size of its frames: " + failure.message(), "");
  session_->stream.reset(arv_camera_create_stream(camera, nullptr, nullptr, failure.slot()));
  ArvStream* stream = session_->stream.get();
  if (stream == nullptr) {
    return problem("cannot be received from: " + failure.message(), "check the firewall and net.core.rmem_max");
  }
  g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
               config_.socket_buffer_bytes, "packet-resend",
               config_.resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
               "frame-retention", static_cast<guint>(config_.frame_retention_ms) * 1000U, nullptr);
  for (int i = 0; i < config_.buffers; ++i) arv_stream_push_buffer(stream, arv_buffer_new_allocate(payload));
  arv_camera_start_acquisition(camera, failure.slot());
  if (failure) return problem("does not start: " + failure.message(), "");
  last_arrival_ = clock_.now();
  return Ok{};
}

FrameOutcome AravisCamera::next(CameraFrame& frame, Duration timeout) {
  if (!session_ || !session_->stream) return FrameOutcome::lost;
  if (session_->control_lost) {
    counters_.lost.add();
    return FrameOutcome::lost;
  }
  ArvStream* stream = session_->stream.get();
  const auto limit_us = std::chrono::duration_cast<std::chrono::microseconds>(timeout).count();
  ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream, static_cast<guint64>(std::max<std::int64_t>(limit_us, 0)));
  if (buffer == nullptr) {
    counters_.timeouts.add();
    return FrameOutcome::timeout;
  }
  const FrameOutcome outcome = take(buffer, frame);
  // In every case, or the stream runs out of buffers.
  arv_stream_push_buffer(stream, buffer);
  count_transport();
  return outcome;
}

FrameOutcome AravisCamera::take(ArvBuffer* buffer, CameraFrame& frame) {
  last_arrival_ = clock_.now();
  const bool complete = arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS;
  const guint64 id = arv_buffer_get_frame_id(buffer);
  if (id == 0) {  // aborted before its first packet
    counters_.note_unnumbered();
    return FrameOutcome::dropped;
  }
  const std::uint64_t step = frame_ids_.advance(id);  // 0: the same picture again
  seq_ += step;
  if (step > 0) counters_.note_gap(step - 1);
  if (!complete || step == 0 || !to_gray(picture_of(buffer, format_), 0, format_.width, frame.view[0])) {
    counters_.incomplete.add();
    return FrameOutcome::dropped;
  }
  frame.seq = seq_;
  frame.views = 1;
  stamp(buffer, frame);
  counters_.frames.add();
  return FrameOutcome::frame;
}

void AravisCamera::stamp(ArvBuffer* buffer, CameraFrame& frame) {
  const std::optional<std::int64_t> chunk_ns = session_->chunks.time_ns(buffer);
  const std::int64_t device_ns = chunk_ns.value_or(static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer)));
  const std::optional<double> chunk_us = session_->chunks.exposure_us(buffer);
  frame.exposure = chunk_us ? Duration(std::llround(*chunk_us * 1000)) : session_->exposure;
  // Aravis notes the wall time of a frame's first packet: less disturbed than the time at which it was fetched here.
  const std::int64_t waited_ns =
      g_get_real_time() * 1000 - static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer));
  const bool credible = waited_ns >= 0 && waited_ns < kLongestWaitNs;  // not when the wall clock was stepped meanwhile
  const Timestamp leader = last_arrival_ + Duration(credible ? -waited_ns : 0);
  const DeviceClock::Mapped mapped = device_clock_.map(device_ns, leader);
  frame.time_source = mapped.from_arrival ? TimeSource::arrival : TimeSource::hardware;
  frame.mid_exposure = mid_exposure(mapped.time, config_.stamp_at, frame.exposure);
  frame.arrival = last_arrival_;
}

void AravisCamera::count_transport() {
  ArvStream* stream = session_->stream.get();
  const auto info = [&](const char* name) { return arv_stream_get_info_uint64_by_name(stream, name); };
  const CameraStatistics& before = session_->before;
  transport_.resend_requests.set(before.resend_requests + info("n_resend_requests"));
  transport_.resent_packets.set(before.resent_packets + info("n_resent_packets"));
  transport_.missing_packets.set(before.missing_packets + info("n_missing_packets"));
  transport_.underruns.set(before.underruns + info("n_underruns"));
}

void AravisCamera::stop() {
  if (!session_) return;
  // Asked always: one that was pulled a moment ago is not missed yet, and would hold up the end of the program.
  if (!session_->answers()) {
    // Aravis takes up to 10 s to let go of a camera that is gone (its retries cannot be set in 0.8). The session owns
    // all that the thread touches, and neither a camera that comes back nor the end of the program waits for it.
    std::thread([gone = std::move(session_)]() mutable { gone.reset(); }).detach();
    return;
  }
  if (session_->stream && !session_->control_lost) arv_camera_stop_acquisition(session_->camera.get(), nullptr);
  session_.reset();
}

CameraStatistics AravisCamera::statistics() const {
  CameraStatistics s = counters_.read();
  s.time_corrections = device_clock_.jumps();
  s.resend_requests = transport_.resend_requests.value();
  s.resent_packets = transport_.resent_packets.value();
  s.missing_packets = transport_.missing_packets.value();
  s.underruns = transport_.underruns.value();
  return s;
}

}  // namespace pelorus
