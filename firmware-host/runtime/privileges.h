#pragma once
// PrivilegeLedger: what the operating system granted of what the process asked for (process_setup.h), in words for
// health and reports. Thread-safe: each thread tells its own outcome at its start; nothing is asked per frame.

#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace pelorus {

class PrivilegeLedger {
 public:
  // `refusal`: empty when granted. What is never told was not asked for.
  void note_realtime(const std::string& refusal);
  void note_memory_lock(const std::string& refusal);
  void note_reserved_memory(const std::string& refusal);  // populate_reserved_memory()
  // The outcome of set_thread(); `pinned`: a processor of its own was asked for.
  void note_thread(const std::string& name, bool pinned, const std::string& refusal);

  // "real time, memory locked, 2 threads pinned"; "no real time: Operation not permitted, memory not locked: ...".
  [[nodiscard]] std::string text() const;
  // One line for each refusal; empty when all was granted.
  [[nodiscard]] std::vector<std::string> refused() const;

 private:
  struct ThreadRefusal {
    std::string name;
    std::string why;
  };
  mutable std::mutex mutex_;
  std::optional<std::string> realtime_;
  std::optional<std::string> memory_lock_;
  std::string reserved_memory_;  // why not populated
  int pinned_ = 0;
  std::vector<ThreadRefusal> threads_;
};

}  // namespace pelorus
