// No heap on the per-frame path (ARCHITECTURE, threads and latency), on no thread: the C allocator itself is replaced
// in this program, so that every library is counted. Not built under sanitizers, which replace it too.

#include <execinfo.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>

#include "core/pipeline/pipeline.h"
#include "services/side_thread.h"
#include "tests/core/pipeline/board_world.h"

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

std::atomic<bool> counting{false};  // in all threads
thread_local bool noting = false;
std::atomic<int> allocations{0};

// Says where the first ones come from; backtrace_symbols_fd does not allocate once its library is loaded.
void note() {
  if (!counting.load(std::memory_order_relaxed) || noting) return;
  noting = true;
  if (++allocations <= 5) {
    void* frames[12];
    const int depth = backtrace(frames, 12);
    backtrace_symbols_fd(frames, depth, STDERR_FILENO);
    (void)!write(STDERR_FILENO, "--\n", 3);
  }
  noting = false;
}

}  // namespace

extern "C" {
void* malloc(std::size_t size) {
  note();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  note();
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  note();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  note();
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? 12 : 0;
}
}

namespace pelorus {
namespace {

constexpr int kRendered = 30;
constexpr int kWarmUp = 10;
constexpr int kCounted = 200;

// There and back again, so that thirty rendered frames make a dive of any length; the board turns with the camera.
int frame_shown(int step) {
  const int place = step % (2 * (kRendered - 1));
  return place < kRendered ? place : 2 * (kRendered - 1) - place;
}

TEST(Allocation, NoneInTwoHundredStepsWithABodyThatComesAndGoes) {
  std::vector<test::StereoImages> images;
  for (int frame = 0; frame < kRendered; ++frame) images.push_back(test::plane_with_board(frame, {}));
  const test::StereoImages grey = test::grey();
  PipelineThreads threads;
  Pipeline pipeline({}, test::kBoardRig, threads.workers(true));
  void* loaded[2];
  (void)backtrace(loaded, 2);
  int with_objects = 0;
  int lost = 0;
  std::int32_t newest_id = 0;
  for (int step = 0; step < kWarmUp + kCounted; ++step) {
    // A loss on the way, so that recovery is counted too.
    const bool blind = step == 90 || step == 91;
    const test::StereoImages& seen = blind ? grey : images[static_cast<std::size_t>(frame_shown(step))];
    const StereoFrame frame{static_cast<std::uint64_t>(step), Timestamp{step * 100'000'000LL}, seen.left.view(),
                            seen.right.view()};
    counting = step >= kWarmUp;
    const FrameResult& result = pipeline.step(frame);
    counting = false;
    with_objects += result.objects_size > 0;
    lost += result.state == VisionState::lost;
    for (const ObjectState& object : result.objects_view()) newest_id = std::max(newest_id, object.id.value);
    EXPECT_TRUE(step <= 100 || result.pose_valid);
  }
  EXPECT_GT(with_objects, 50);
  EXPECT_EQ(lost, 3);       // the two grey frames, and the next, which only starts points
  EXPECT_GT(newest_id, 1);  // bodies ended and others were born
  EXPECT_EQ(allocations.load(), 0);
}

TEST(Allocation, TheCounterCounts) {
  const int before = allocations.load();
  counting = true;
  std::vector<int>* made = new std::vector<int>(100);
  asm volatile("" : : "r"(made->data()) : "memory");  // else the compiler may do without
  counting = false;
  delete made;
  EXPECT_GE(allocations.load() - before, 2);
}

}  // namespace
}  // namespace pelorus
