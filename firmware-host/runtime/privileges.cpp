#include "firmware-host/runtime/privileges.h"

namespace pelorus {
namespace {

std::string of_wish(const std::optional<std::string>& refusal, const char* granted, const char* refused,
                    const char* not_asked) {
  if (!refusal) return not_asked;
  return refusal->empty() ? granted : refused + (": " + *refusal);
}

}  // namespace

void PrivilegeLedger::note_realtime(const std::string& refusal) {
  const std::lock_guard lock(mutex_);
  realtime_ = refusal;
}

void PrivilegeLedger::note_memory_lock(const std::string& refusal) {
  const std::lock_guard lock(mutex_);
  memory_lock_ = refusal;
}

void PrivilegeLedger::note_reserved_memory(const std::string& refusal) {
  const std::lock_guard lock(mutex_);
  reserved_memory_ = refusal;
}

void PrivilegeLedger::note_thread(const std::string& name, bool pinned, const std::string& refusal) {
  const std::lock_guard lock(mutex_);
  if (!refusal.empty()) threads_.push_back({name, refusal});
  pinned_ += pinned && refusal.empty() ? 1 : 0;
}

std::string PrivilegeLedger::text() const {
  const std::lock_guard lock(mutex_);
  std::string text = of_wish(realtime_, "real time", "no real time", "real time not asked for") + ", " +
                     of_wish(memory_lock_, "memory locked", "memory not locked", "memory lock not asked for") + ", " +
                     (pinned_ > 0 ? std::to_string(pinned_) : std::string("no")) + " threads pinned";
  if (!reserved_memory_.empty()) text += ", reserved memory not populated: " + reserved_memory_;
  for (const ThreadRefusal& thread : threads_) text += ", thread " + thread.name + " refused: " + thread.why;
  return text;
}

std::vector<std::string> PrivilegeLedger::refused() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> all;
  if (memory_lock_ && !memory_lock_->empty()) all.push_back("memory lock: " + *memory_lock_);
  if (!reserved_memory_.empty()) all.push_back("reserved memory populated: " + reserved_memory_);
  if (realtime_ && !realtime_->empty()) all.push_back("real-time scheduling: " + *realtime_);
  for (const ThreadRefusal& thread : threads_)
    all.push_back("class or processor of thread " + thread.name + ": " + thread.why);
  return all;
}

}  // namespace pelorus
