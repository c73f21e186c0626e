#include "firmware-host/pelorus/bench/latency_run.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <thread>

#include "core/geometry/rectifier.h"
#include "drivers/source_camera.h"
#include "firmware-host/pelorus/bench/allocation_counter.h"
#include "firmware-host/runtime/privileges.h"
#include "firmware-host/runtime/process_setup.h"
#include "firmware-host/runtime/reserved_memory.h"
#include "services/capture.h"
#include "services/publish_thread.h"
#include "services/side_thread.h"
#include "services/vision.h"

namespace pelorus {
namespace {

constexpr int kRingSlots = 8;

// Keeps what each result cost, in memory that is there from the start.
class Probe final : public Publisher {
 public:
  explicit Probe(std::size_t capacity) { steps_.reserve(capacity); }

  void publish(const Publication& p) override {
    if (!counting_.load(std::memory_order_acquire) || !p.has_picture || steps_.size() == steps_.capacity()) return;
    ReleasedStep step;
    step.report = p.result.report;
    step.state = p.result.state;
    step.pose_valid = p.result.pose_valid;
    step.deadline_missed = p.deadline_missed;
    step.objects = p.result.objects_size;
    step.ready_ms = seconds(p.ready - p.result.capture_time) * 1e3;
    step.released_ms = seconds(p.released - p.result.capture_time) * 1e3;
    step.late_us = seconds(p.released - p.release_due) * 1e6;
    steps_.push_back(step);
  }
  void count(bool on) { counting_.store(on, std::memory_order_release); }
  // Once nobody publishes any more.
  [[nodiscard]] std::vector<ReleasedStep> take() { return std::move(steps_); }

 private:
  std::atomic<bool> counting_{false};
  std::vector<ReleasedStep> steps_;
};

double resident_mb(const char* field) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kb = 0;
    if (word == field && status >> kb) return kb / 1024;
  }
  return 0;
}

// Minor and major page faults of a thread since its start (proc(5): fields 10 and 12 of its stat).
std::uint64_t page_faults(const std::filesystem::path& task) {
  std::ifstream file(task / "stat");
  const std::string stat(std::istreambuf_iterator<char>(file), {});
  const std::size_t name_end = stat.rfind(')');  // the name may hold anything before it, brackets and lines too
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(stat.substr(name_end + 1));
  std::string skipped;
  for (int field = 3; field < 10; ++field) fields >> skipped;
  std::uint64_t minor = 0;
  std::uint64_t minor_of_children = 0;
  std::uint64_t major = 0;
  fields >> minor >> minor_of_children >> major;
  return minor + major;
}

// What each thread cost so far, by its name.
std::map<std::string, ThreadCost> thread_costs() {
  std::map<std::string, ThreadCost> costs;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream name_file(task.path() / "comm");
    std::ifstream time_file(task.path() / "schedstat");
    std::string name;
    double ns = 0;
    if (!std::getline(name_file, name) || !(time_file >> ns)) continue;
    ThreadCost& cost = costs[name];
    cost.name = name;
    cost.cpu_ms += ns * 1e-6;
    cost.page_faults += page_faults(task.path());
  }
  return costs;
}

struct Snapshot {
  std::map<std::string, ThreadCost> threads = thread_costs();
  rusage usage = [] {
    rusage u{};
    ::getrusage(RUSAGE_SELF, &u);
    return u;
  }();
  std::uint64_t allocations = counted_allocations();
  std::chrono::steady_clock::time_point time = std::chrono::steady_clock::now();
};

void tell_difference(const Snapshot& before, const Snapshot& after, LatencyRun& run) {
  run.seconds = std::chrono::duration<double>(after.time - before.time).count();
  run.allocations = after.allocations - before.allocations;
  run.minor_faults = static_cast<std::uint64_t>(after.usage.ru_minflt - before.usage.ru_minflt);
  run.major_faults = static_cast<std::uint64_t>(after.usage.ru_majflt - before.usage.ru_majflt);
  for (const auto& [name, total] : after.threads) {
    ThreadCost cost = total;
    if (const auto earlier = before.threads.find(name); earlier != before.threads.end()) {
      // A thread that ended in between took what it had cost along, and others may bear its name.
      cost.cpu_ms = std::max(0.0, cost.cpu_ms - earlier->second.cpu_ms);
      cost.page_faults -= std::min(cost.page_faults, earlier->second.page_faults);
    }
    run.threads.push_back(cost);
  }
}

// Built from the end of the chain to its beginning, ended in the opposite order, as in the service.
class Chain {
 public:
  Chain(const std::shared_ptr<const PreloadedPairs>& pairs, const LatencyOptions& options, const Rectifier& rectifier,
        bool realtime, Probe& probe, PrivilegeLedger& privileges)
      : privileges_(privileges),
        timing_(options.config.timing),
        ring_(kRingSlots, FrameFormat{pairs->calibration.left.width, pairs->calibration.left.height, 2}),
        sync_(ring_),
        threads_{SideThread(prepared("klt", ThreadClass::fifo_middle, realtime, options.config.process.pin ? 1 : -1)),
                 SideThread(prepared("surf", ThreadClass::fifo_low, realtime)),
                 SideThread(prepared("refine", ThreadClass::fifo_behind, realtime))},
        publishing_(desk_, {&probe}, timing_, clock_, prepared("publish", ThreadClass::fifo_release, realtime)),
        vision_(
            VisionParts{sync_, rectifier, desk_.results, control_, clock_, nullptr, nullptr, threads_.workers(false)},
            options.config.pipeline, options.config.capture, timing_,
            prepared("vision", ThreadClass::fifo_middle, realtime, options.config.process.pin ? 0 : -1)) {
    auto camera = std::make_unique<SourceCamera>(
        [pairs] { return Result<std::unique_ptr<StereoSource>>(std::make_unique<PreloadedSource>(pairs)); },
        PaceConfig{options.rate_hz, false}, clock_);
    camera_ = camera.get();
    capture_.emplace(std::move(camera), ring_, CaptureConfig{}, prepared("capture", ThreadClass::fifo_high, realtime));
  }
  ~Chain() { capture_.reset(); }

  [[nodiscard]] std::uint64_t superseded() const { return sync_.statistics().superseded; }
  [[nodiscard]] std::uint64_t late() const { return camera_->late(); }
  [[nodiscard]] std::uint64_t results_dropped() const { return desk_.results.dropped(); }
  // The publish thread's samples are read by nobody else here.
  void drain() {
    while (desk_.samples.try_pop()) {
    }
  }

 private:
  std::function<void()> prepared(const char* name, ThreadClass wanted, bool realtime, int processor = -1) {
    return [=, this] {
      count_allocations_of_this_thread();
      const int pinned = realtime && processor >= 0 ? processor_to_bind(processor) : kAnyProcessor;
      const std::string why = set_thread(name, realtime ? wanted : ThreadClass::normal, pinned);
      privileges_.note_thread(name, pinned != kAnyProcessor, why);
    };
  }

  PrivilegeLedger& privileges_;
  TimingConfig timing_;
  CaptureClock clock_;
  PublishDesk desk_;
  VisionControl control_;
  FrameRing ring_;
  StereoSync sync_;
  PipelineThreads threads_;
  PublishThread publishing_;
  Vision vision_;
  SourceCamera* camera_ = nullptr;  // owned by capture_
  std::optional<Capture> capture_;
};

// False when asked to stop.
bool let_run(Chain& chain, double for_s, const LatencyOptions& options, const std::function<void(double)>& progress) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  for (double done_s = 0; done_s < for_s;) {
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(0.1, for_s - done_s)));
    done_s = std::chrono::duration<double>(Clock::now() - start).count();
    chain.drain();
    if (progress) progress(std::min(1.0, done_s / for_s));
    if (options.stop && options.stop()) return false;
  }
  return true;
}

}  // namespace

Result<LatencyRun> run_latency(std::shared_ptr<const PreloadedPairs> pairs, const LatencyOptions& options) {
  const Result<Rectifier> rectifier = Rectifier::create(pairs->calibration, "calibration");
  if (!rectifier) return rectifier.error();
  LatencyRun run;
  const double held_mb = static_cast<double>(pairs->bytes()) / (1 << 20);
  PrivilegeLedger privileges;
  if (options.config.process.lock_memory) privileges.note_memory_lock(lock_memory());
  bool realtime = options.config.process.realtime;
  if (realtime) {
    const std::string why = realtime_refusal();
    privileges.note_realtime(why);
    realtime = why.empty();
  }
  Probe probe(static_cast<std::size_t>(options.seconds * options.rate_hz * 1.2) + 100);
  auto chain = std::make_unique<Chain>(pairs, options, rectifier.value(), realtime, probe, privileges);
  if (options.config.process.lock_memory) privileges.note_reserved_memory(populate_reserved_memory());
  run.interrupted = !let_run(*chain, options.warm_up_s, options, {});
  run.rss_start_mb = resident_mb("VmRSS:") - held_mb;
  const std::uint64_t superseded = chain->superseded();
  const std::uint64_t late = chain->late();
  const Snapshot before;
  probe.count(true);
  run.interrupted = run.interrupted || !let_run(*chain, options.seconds, options, options.progress);
  probe.count(false);
  const Snapshot after;
  tell_difference(before, after, run);
  run.pairs_superseded = chain->superseded() - superseded;
  run.pairs_late = chain->late() - late;
  run.results_dropped = chain->results_dropped();
  run.rss_end_mb = resident_mb("VmRSS:") - held_mb;
  run.rss_peak_mb = resident_mb("VmHWM:") - held_mb;
  chain.reset();
  run.steps = probe.take();
  run.refused = privileges.refused();
  return run;
}

}  // namespace pelorus
