#pragma once
// IncompleteMark: the file INCOMPLETE in the folder of a run, there from before the first result until the recording's
// last pair is written. The result files get their names at once, so that a long run can be watched and a killed one
// is not lost; the mark is what tells them from those of a whole run, also after a power cut or on a full disk.
// Thread-bound.

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.h"

namespace pelorus {

class IncompleteMark {
 public:
  // The folder must exist. An Error, and no file, when nothing can be written there.
  [[nodiscard]] static Result<IncompleteMark> set(const std::filesystem::path& folder);
  // Why the run ended early. Where that cannot be written the mark stays as it was.
  void explain(const std::string& reason) const;
  // The run is whole.
  [[nodiscard]] Result<> clear() const;

 private:
  explicit IncompleteMark(std::filesystem::path file) : file_(std::move(file)) {}
  std::filesystem::path file_;
};

// What the mark in a run's folder says; absent without one.
[[nodiscard]] std::optional<std::string> incomplete_reason(const std::filesystem::path& folder);

// The same as a line for stderr, of the verbs that read runs; empty without a mark.
[[nodiscard]] std::string incomplete_warning(const std::filesystem::path& folder);

// Exit code of a verb that has done its work on a run: 0, or 3 with a mark, as `replay` for what lacks something.
[[nodiscard]] int done_exit_code(const std::filesystem::path& folder);

}  // namespace pelorus
