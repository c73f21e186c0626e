#include "firmware-host/pelorus/results/scene_reader.h"

#include <optional>
#include <string>

#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/pelorus/results/result_reader_table.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

// Absent when there is no such file; complains of the first column that is missing.
Result<std::optional<TextTable>> read_table(const fs::path& file, std::initializer_list<const char*> columns) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::optional<TextTable>();
  Result<TextTable> table = TextTable::read_of_run(file, TableHeader::first_line);
  if (!table) return table.error();
  if (table.value().blank()) return std::optional<TextTable>();
  for (const char* name : columns) {
    if (table.value().find(name)) continue;
    return Error{ErrorCode::bad_input, file.string() + ":1", "column '" + std::string(name) + "' is missing",
                 "the file is not one that `pelorus replay` writes"};
  }
  return std::optional<TextTable>(std::move(table.value()));
}

Eigen::Vector3d point_at(TextTable& table, std::size_t row, std::size_t column) {
  return {table.number(row, column), table.number(row, column + 1), table.number(row, column + 2)};
}

}  // namespace

Result<std::vector<ScenePoint>> read_points(const fs::path& folder) {
  Result<std::optional<TextTable>> read =
      read_table(ResultPaths(folder).points,
                 {"object_id", "track", "p_x", "p_y", "p_z", "spread_m", "views", "first_ns", "last_ns", "gray"});
  if (!read) return read.error();
  std::vector<ScenePoint> points;
  if (!read.value()) return points;
  TextTable& table = *read.value();
  const auto column = [&table](const char* name) { return *table.find(name); };
  const std::size_t id = column("object_id"), track = column("track"), p = column("p_x"), spread = column("spread_m"),
                    views = column("views"), first = column("first_ns"), last = column("last_ns"),
                    gray = column("gray");
  points.reserve(table.size());
  for (std::size_t row = 0; row < table.size(); ++row) {
    ScenePoint point;
    point.body = BodyId{static_cast<std::int32_t>(table.integer(row, id))};
    point.track = TrackId{static_cast<std::uint64_t>(table.integer(row, track))};
    point.p_body = point_at(table, row, p);
    point.spread_m = table.number(row, spread);
    point.views = static_cast<int>(table.integer(row, views));
    point.first_seen = Timestamp{table.integer(row, first)};
    point.last_seen = Timestamp{table.integer(row, last)};
    point.gray = static_cast<int>(table.integer(row, gray));
    if (point.body < kWorldBody) table.complain(row, "no body has a number below 0");
    if (point.gray < 0 || point.gray > 255) table.complain(row, "'gray' is not within 0 to 255");
    if (table.problem()) return *table.problem();
    points.push_back(point);
  }
  return points;
}

Result<std::vector<SceneOutline>> read_outlines(const fs::path& folder) {
  Result<std::optional<TextTable>> read =
      read_table(ResultPaths(folder).outlines, {"timestamp_ns", "object_id", "p_x", "p_y", "p_z"});
  if (!read) return read.error();
  std::vector<SceneOutline> outlines;
  if (!read.value()) return outlines;
  TextTable& table = *read.value();
  const std::size_t time = *table.find("timestamp_ns"), id = *table.find("object_id"), p = *table.find("p_x");
  for (std::size_t row = 0; row < table.size(); ++row) {
    const Timestamp capture_time{table.integer(row, time)};
    const BodyId body{static_cast<std::int32_t>(table.integer(row, id))};
    const Eigen::Vector3d corner = point_at(table, row, p);
    if (table.problem()) return *table.problem();
    if (outlines.empty() || outlines.back().capture_time != capture_time || outlines.back().body != body) {
      outlines.push_back({capture_time, body, {}});
    }
    outlines.back().corners_obj.push_back(corner);
  }
  return outlines;
}

}  // namespace pelorus
