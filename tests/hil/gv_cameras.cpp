// Recorded pairs as two GigE Vision cameras on this machine: Aravis' fake camera, the real protocols over UDP. Both
// fire at the multiples of the period on the wall clock and show the pair of that moment, forth and back through the
// recording, so that its motion never jumps. Faults are injected by lines on standard input:
//   off SIDE | on SIDE | loss SIDE SHARE | freeze SIDE 0|1 | late SIDE PAIRS | clock SIDE SECONDS | swap SIDE 0|1
// SIDE: left or right; swap: that camera shows the pictures of the other.
//
// usage: gv_cameras DATASET LEFT_ADDRESS RIGHT_ADDRESS RATE_HZ [SHOWN_CSV]      ends at end of input
// SHOWN_CSV: at the end, every picture that either camera took: side, time on the wall clock, index in the recording.

#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tests/hil/film.h"
#include "tests/support/fake_gv_camera.h"

namespace pelorus {
namespace {

constexpr std::size_t kMostShown = 1'000'000;  // hours

// One of the two cameras and what is wrong with it.
class Side {
 public:
  Side(const std::vector<Image>& frames, const std::vector<Image>& others, std::string address, std::string serial,
       double rate_hz)
      : frames_(frames),
        others_(others),
        address_(std::move(address)),
        serial_(std::move(serial)),
        period_ns_(1e9 / rate_hz) {
    log_.reserve(kMostShown);
  }

  bool on() {
    camera_ = std::make_unique<test::FakeGvCamera>(
        address_, serial_, frames_[0].width(), frames_[0].height(),
        [this](std::uint8_t* pixels, int width, int height, std::int64_t t) { paint(pixels, width, height, t); });
    camera_->set_clock_offset(clock_offset_ns_);
    camera_->stamp_ticks_of(std::llround(period_ns_));
    return camera_->running();
  }
  void off() {
    painted_before_ = painted();
    camera_.reset();
  }
  void lose(double share) {
    if (camera_) camera_->lose_packets(share);
  }
  void set_clock(double seconds) {
    clock_offset_ns_ = static_cast<std::int64_t>(seconds * 1e9);
    if (camera_) camera_->set_clock_offset(clock_offset_ns_);
  }
  void freeze(bool frozen) { frozen_ = frozen; }
  void delay(int pairs) { late_ = pairs; }
  void swap(bool swapped) { swapped_ = swapped; }
  // Of a camera that is off.
  [[nodiscard]] const std::vector<Shown>& log() const { return log_; }
  [[nodiscard]] std::uint64_t painted() const { return painted_before_ + (camera_ ? camera_->painted() : 0); }

 private:
  void paint(std::uint8_t* pixels, int width, int height, std::int64_t time_ns) {
    // The tick at which it fired: painting is late under load, early never by more than a clock's grain.
    const auto tick = static_cast<std::int64_t>(std::floor(static_cast<double>(time_ns) / period_ns_ + 0.25));
    if (!frozen_) shown_ = Film::index_at(tick - late_, frames_.size());
    if (log_.size() < kMostShown) log_.push_back({std::llround(static_cast<double>(tick) * period_ns_), shown_});
    const Image& frame = (swapped_ ? others_ : frames_)[shown_];
    for (int v = 0; v < height && v < frame.height(); ++v)
      std::copy_n(frame.row(v), std::min(width, frame.width()), pixels + static_cast<std::ptrdiff_t>(v) * width);
  }
  const std::vector<Image>& frames_;
  const std::vector<Image>& others_;  // of the other camera
  std::string address_;
  std::string serial_;
  double period_ns_;
  std::atomic<bool> frozen_{false};
  std::atomic<bool> swapped_{false};
  std::atomic<int> late_{0};
  std::size_t shown_ = 0;   // camera's thread
  std::vector<Shown> log_;  // camera's thread
  std::int64_t clock_offset_ns_ = 0;
  std::uint64_t painted_before_ = 0;  // by its instances switched off
  std::unique_ptr<test::FakeGvCamera> camera_;
};

void obey(const std::string& line, std::array<Side*, 2> sides) {
  std::istringstream words(line);
  std::string verb;
  std::string name;
  double value = 0;
  words >> verb >> name >> value;
  if (name != "left" && name != "right") {
    std::fprintf(stderr, "gv_cameras: '%s' names no side\n", line.c_str());
    return;
  }
  Side& side = *sides[name == "left" ? 0 : 1];
  std::printf("obeyed %lld %s\n", static_cast<long long>(g_get_real_time() * 1000), line.c_str());
  if (verb == "off") return side.off();
  if (verb == "on" && !side.on()) std::fprintf(stderr, "gv_cameras: %s does not come up\n", name.c_str());
  if (verb == "loss") side.lose(value);
  if (verb == "freeze") side.freeze(value != 0);
  if (verb == "swap") side.swap(value != 0);
  if (verb == "late") side.delay(static_cast<int>(value));
  if (verb == "clock") side.set_clock(value);
}

int run(int count, char** arguments) {
  const Result<Film> film = Film::load(arguments[1]);
  if (!film) {
    std::fprintf(stderr, "%s\n", film.error().message().c_str());
    return exit_code(film.error().code);
  }
  const double rate_hz = std::atof(arguments[4]);
  if (rate_hz <= 0) return 2;
  const std::vector<Image>(&frames)[2] = film.value().frames;
  Side left(frames[0], frames[1], arguments[2], "left", rate_hz);
  Side right(frames[1], frames[0], arguments[3], "right", rate_hz);
  if (!left.on() || !right.on()) {
    std::fprintf(stderr, "gv_cameras: no such address on this machine\n");
    return 7;
  }
  std::printf("ready: %zu pairs\n", film.value().frames[0].size());
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) obey(line, {&left, &right});
  std::printf("painted %llu %llu\n", static_cast<unsigned long long>(left.painted()),
              static_cast<unsigned long long>(right.painted()));
  left.off();
  right.off();
  if (count > 5 && !write_shown(arguments[5], left.log(), right.log())) {
    std::fprintf(stderr, "gv_cameras: cannot write %s\n", arguments[5]);
    return 6;
  }
  return 0;
}

}  // namespace
}  // namespace pelorus

int main(int count, char** arguments) {
  if (count != 5 && count != 6) {
    std::fprintf(stderr, "usage: gv_cameras DATASET LEFT_ADDRESS RIGHT_ADDRESS RATE_HZ [SHOWN_CSV]\n");
    return 2;
  }
  return pelorus::run(count, arguments);
}
