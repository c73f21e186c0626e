#include "firmware-host/pelorus/results/stage_reader.h"

#include <string>

#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/pelorus/results/result_reader_table.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

Error missing_column(const fs::path& file, const std::string& name) {
  return {ErrorCode::bad_input, file.string() + ":1", "column '" + name + "' is missing",
          "the file is not one that `pelorus replay` writes"};
}

void count_outcome(TextTable& table, std::size_t row, std::size_t column, std::size_t stage, StageRecord& record) {
  const std::string& text = table.text(row, column);
  for (std::size_t i = 0; i < kOutcomeCount; ++i) {
    if (text != to_text(static_cast<StageOutcome>(i))) continue;
    ++record.outcomes[stage][i];
    return;
  }
  table.complain(row, "'" + text + "' is no outcome of a stage");
}

Result<Ok> read_outcomes(const fs::path& file, StageRecord& record) {
  Result<TextTable> read = TextTable::read_of_run(file, TableHeader::first_line);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.blank()) return Ok{};
  for (const char* name : {"timestamp_ns", "points_tracked", "points_static", "points_moving", "points_outlier"}) {
    if (!table.find(name)) return missing_column(file, name);
  }
  const auto count = [&](std::size_t row, const char* name) {
    return static_cast<int>(table.integer(row, *table.find(name)));
  };
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    const char* name = to_text(static_cast<Stage>(stage));
    const auto column = table.find(name);
    if (!column) return missing_column(file, name);
    for (std::size_t row = 0; row < table.size(); ++row) count_outcome(table, row, *column, stage, record);
  }
  for (std::size_t row = 0; row < table.size(); ++row) {
    record.points.push_back({Timestamp{table.integer(row, *table.find("timestamp_ns"))}, count(row, "points_tracked"),
                             count(row, "points_static"), count(row, "points_moving"), count(row, "points_outlier")});
  }
  if (table.problem()) return *table.problem();
  return Ok{};
}

Result<Ok> read_times(const fs::path& file, StageRecord& record) {
  constexpr double kMsPerUs = 1e-3;
  Result<TextTable> read = TextTable::read_of_run(file, TableHeader::first_line);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.blank()) return Ok{};
  for (const char* name : {"rectify_us", "step_us"}) {
    if (!table.find(name)) return missing_column(file, name);
  }
  for (std::size_t row = 0; row < table.size(); ++row) {
    const std::int64_t rectify_us = table.integer(row, *table.find("rectify_us"));
    const std::int64_t step_us = table.integer(row, *table.find("step_us"));
    if (rectify_us < 0 || step_us < 0) table.complain(row, "a time below 0");
    record.latency_ms.push_back(static_cast<double>(rectify_us + step_us) * kMsPerUs);
  }
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    const auto column = table.find(std::string(to_text(static_cast<Stage>(stage))) + "_us");
    if (!column) return missing_column(file, std::string(to_text(static_cast<Stage>(stage))) + "_us");
    for (std::size_t row = 0; row < table.size(); ++row) {
      record.stage_ms[stage].push_back(table.number(row, *column) * kMsPerUs);
    }
  }
  if (table.problem()) return *table.problem();
  return Ok{};
}

}  // namespace

Result<StageRecord> read_stages(const fs::path& folder) {
  const ResultPaths paths(folder);
  StageRecord record;
  std::error_code ignored;
  if (fs::is_regular_file(paths.frames, ignored)) {
    if (Result<Ok> read = read_outcomes(paths.frames, record); !read) return read.error();
  }
  if (fs::is_regular_file(paths.timing, ignored)) {
    if (Result<Ok> read = read_times(paths.timing, record); !read) return read.error();
  }
  return record;
}

}  // namespace pelorus
