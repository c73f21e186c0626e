#include "firmware-host/pelorus/results/incomplete_mark.h"

#include <fstream>

#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/runtime/partial_file.h"

namespace pelorus {
namespace {

Result<> write_reason(const std::filesystem::path& file, const std::string& reason) {
  Result<PartialFile> written = PartialFile::create(file, true);
  if (!written) return written.error();
  written.value().write(reason + "\n");
  return written.value().finish();
}

}  // namespace

Result<IncompleteMark> IncompleteMark::set(const std::filesystem::path& folder) {
  const IncompleteMark mark(ResultPaths(folder).incomplete);
  const Result<> written =
      write_reason(mark.file_, "the replay has not come to its end: it is under way or was killed");
  if (!written) return written.error();
  return mark;
}

void IncompleteMark::explain(const std::string& reason) const { (void)write_reason(file_, reason).ok(); }

Result<> IncompleteMark::clear() const {
  std::error_code error;
  std::filesystem::remove(file_, error);
  if (!error) return Ok{};
  return Error{ErrorCode::io, file_.string(), "cannot be removed: " + error.message(), "the run is whole; remove it"};
}

std::optional<std::string> incomplete_reason(const std::filesystem::path& folder) {
  const std::filesystem::path file = ResultPaths(folder).incomplete;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  std::string reason;
  std::ifstream in(file);
  std::getline(in, reason);
  return reason.empty() ? "no reason is noted" : reason;
}

std::string incomplete_warning(const std::filesystem::path& folder) {
  const auto reason = incomplete_reason(folder);
  return reason ? "pelorus: " + folder.string() + ": the run is INCOMPLETE: " + *reason + "\n" : "";
}

int done_exit_code(const std::filesystem::path& folder) {
  return incomplete_reason(folder) ? exit_code(ErrorCode::bad_input) : 0;
}

}  // namespace pelorus
