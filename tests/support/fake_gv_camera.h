#pragma once
// A GigE Vision camera made of software: Aravis' fake camera, speaking GVCP and GVSP over UDP on an address of this
// machine, with pictures of our own. It fires at the multiples of its period on the wall clock, so that several of
// them fire together, as triggered cameras do.

#include <arv.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace pelorus::test {

class FakeGvCamera {
 public:
  // Fills `pixels` (width * height bytes) for the exposure at `time_ns` of the wall clock. Runs on the camera's thread.
  using Paint = std::function<void(std::uint8_t* pixels, int width, int height, std::int64_t time_ns)>;

  FakeGvCamera(const std::string& address, const std::string& serial, int width, int height, Paint paint)
      : paint_(std::move(paint)) {
    camera_ = static_cast<ArvGvFakeCamera*>(g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name", address.c_str(),
                                                         "serial-number", serial.c_str(), nullptr));
    ArvFakeCamera* registers = arv_gv_fake_camera_get_fake_camera(camera_);
    arv_fake_camera_set_fill_pattern(registers, &FakeGvCamera::fill, this);
    arv_fake_camera_write_register(registers, ARV_FAKE_CAMERA_REGISTER_WIDTH, static_cast<guint32>(width));
    arv_fake_camera_write_register(registers, ARV_FAKE_CAMERA_REGISTER_HEIGHT, static_cast<guint32>(height));
  }
  ~FakeGvCamera() { g_object_unref(camera_); }
  FakeGvCamera(const FakeGvCamera&) = delete;
  FakeGvCamera& operator=(const FakeGvCamera&) = delete;

  [[nodiscard]] bool running() const { return arv_gv_fake_camera_is_running(camera_) != 0; }
  [[nodiscard]] std::uint64_t painted() const { return painted_; }
  void lose_packets(double share) { g_object_set(camera_, "gvsp-lost-ratio", share, nullptr); }
  // Stamps the multiple of the period at which it fired, as a triggered camera does, not the moment at which this
  // computer came to paint the picture. 0 = off.
  void stamp_ticks_of(std::int64_t period_ns) { tick_ns_ = period_ns; }
  // Of the camera's own clock against the wall clock.
  void set_clock_offset(std::int64_t offset_ns) { clock_offset_ns_ = offset_ns; }

 private:
  static void fill(ArvBuffer* buffer, void* data, guint32, guint32, ArvPixelFormat) {
    auto* self = static_cast<FakeGvCamera*>(data);
    const std::int64_t now_ns = g_get_real_time() * 1000;
    // The size reported is 0 here; the memory is that of the whole payload.
    auto* pixels = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, nullptr)));
    self->paint_(pixels, arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer), now_ns);
    const std::int64_t tick_ns = self->tick_ns_;
    const std::int64_t fired_ns = tick_ns > 0 ? (now_ns + tick_ns / 4) / tick_ns * tick_ns : now_ns;
    arv_buffer_set_timestamp(buffer, static_cast<guint64>(fired_ns + self->clock_offset_ns_));
    ++self->painted_;
  }

  ArvGvFakeCamera* camera_ = nullptr;
  Paint paint_;
  std::atomic<std::uint64_t> painted_{0};
  std::atomic<std::int64_t> clock_offset_ns_{0};
  std::atomic<std::int64_t> tick_ns_{0};
};

}  // namespace pelorus::test
