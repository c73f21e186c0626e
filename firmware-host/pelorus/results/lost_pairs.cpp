#include "firmware-host/pelorus/results/lost_pairs.h"

#include <cinttypes>

#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/pelorus/results/result_reader_table.h"

namespace pelorus {

std::string to_text(const LostPairs& lost) {
  return std::to_string(lost.missing) + " missing in the recording, " + std::to_string(lost.unreadable) +
         " unreadable, " + std::to_string(lost.dropped) + " dropped";
}

Result<> write_lost_pairs(const std::filesystem::path& folder, const LostPairs& lost) {
  Result<ResultFile> file = ResultFile::create(ResultPaths(folder).lost_pairs, "missing,unreadable,dropped");
  if (!file) return file.error();
  std::fprintf(file.value().get(), "%" PRIu64 ",%" PRIu64 ",%" PRIu64 "\n", lost.missing, lost.unreadable,
               lost.dropped);
  return file.value().flush();
}

Result<std::optional<LostPairs>> read_lost_pairs(const std::filesystem::path& folder) {
  const std::filesystem::path file = ResultPaths(folder).lost_pairs;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::optional<LostPairs>();
  Result<TextTable> read = TextTable::read_of_run(file, TableHeader::first_line);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.blank()) return std::optional<LostPairs>();
  if (table.size() != 1 || table.columns() != 3) {
    return Error{ErrorCode::bad_input, file.string(), "does not hold one row of three counts",
                 "remove the file: gaps between frames are counted then, or repeat the run"};
  }
  const auto count = [&table](std::size_t column) { return static_cast<std::uint64_t>(table.integer(0, column)); };
  const LostPairs lost{count(0), count(1), count(2)};
  if (table.problem()) return *table.problem();
  return std::optional<LostPairs>(lost);
}

}  // namespace pelorus
