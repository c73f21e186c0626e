#include "firmware-host/pelorus/results/result_reader_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "firmware-host/pelorus/results/incomplete_mark.h"

namespace pelorus {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::string field;
  bool after_comma = false;
  const auto finish = [&](bool at_comma) {
    if (!field.empty() || (at_comma && after_comma)) fields.push_back(field);
    field.clear();
  };
  for (const char c : line) {
    if (c == ',') {
      finish(true);
      after_comma = true;
    } else if (is_blank(c)) {
      if (!field.empty()) {
        finish(false);
        after_comma = false;
      }
    } else {
      field += c;
    }
  }
  finish(after_comma);
  return fields;
}

// A rotation read from text may be off by its last digits, not by more.
constexpr double kUnitTolerance = 1e-3;

}  // namespace

Result<TextTable> TextTable::read_of_run(const std::filesystem::path& file, TableHeader header) {
  return read(file, header, incomplete_reason(file.parent_path()) ? CutLine::leave_away : CutLine::refuse);
}

Result<TextTable> TextTable::read(const std::filesystem::path& file, TableHeader header, CutLine cut_line) {
  std::ifstream stream(file);
  if (!stream) return Error{ErrorCode::bad_input, file.string(), "cannot be opened", "check the path"};
  TextTable table;
  table.file_ = file;
  std::string line;
  bool wants_header = header == TableHeader::first_line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (stream.eof() && cut_line == CutLine::leave_away) break;
    std::vector<std::string> fields = split(line);
    if (fields.empty() || fields.front().front() == '#') continue;
    if (table.columns_ == 0) table.columns_ = fields.size();
    if (fields.size() != table.columns_) {
      return Error{ErrorCode::bad_input, file.string() + ":" + std::to_string(number),
                   std::to_string(fields.size()) + " fields where " + std::to_string(table.columns_) + " are expected",
                   "the file was cut off or damaged: repeat the run, or delete this line"};
    }
    if (wants_header) {
      table.header_ = std::move(fields);
      wants_header = false;
    } else {
      table.rows_.push_back({number, std::move(fields)});
    }
  }
  if (wants_header && cut_line == CutLine::refuse)
    return Error{ErrorCode::bad_input, file.string(), "empty file", "repeat the run that wrote it"};
  return table;
}

std::optional<std::size_t> TextTable::find(const std::string& name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header_.begin());
}

const std::string& TextTable::text(std::size_t row, std::size_t column) const { return rows_[row].fields[column]; }

void TextTable::complain(std::size_t row, const std::string& detail) {
  if (problem_) return;
  problem_ = Error{ErrorCode::bad_input, file_.string() + ":" + std::to_string(rows_[row].line), detail, ""};
}

double TextTable::number(std::size_t row, std::size_t column) {
  const std::string& field = text(row, column);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error == std::errc() && end == field.data() + field.size() && std::isfinite(value)) return value;
  complain(row, "'" + field + "' in column " + std::to_string(column + 1) + " is no finite number");
  return 0;
}

std::int64_t TextTable::integer(std::size_t row, std::size_t column) {
  const std::string& field = text(row, column);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error == std::errc() && end == field.data() + field.size()) return value;
  complain(row, "'" + field + "' in column " + std::to_string(column + 1) + " is no integer");
  return 0;
}

Timestamp TextTable::time_of_seconds(std::size_t row, std::size_t column) {
  const std::string& field = text(row, column);
  const std::size_t point = field.find('.');
  // 1403715273.262142976 does not fit into a double: whole seconds and fraction are read apart.
  const bool plain = point != std::string::npos && field.find_first_not_of("0123456789.") == std::string::npos &&
                     field.size() - point - 1 <= 9 && point > 0 && point < 10;
  if (!plain) return Timestamp{std::llround(number(row, column) * 1e9)};
  std::string digits = field.substr(0, point) + field.substr(point + 1);
  digits.append(9 - (field.size() - point - 1), '0');
  std::int64_t ns = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), ns);
  return Timestamp{ns};
}

Rigid3 TextTable::rigid(std::size_t row, std::size_t column, bool w_first) {
  const std::size_t q = column + 3;
  const std::size_t w = w_first ? q : q + 3;
  const std::size_t x = w_first ? q + 1 : q;
  Eigen::Quaterniond rotation(number(row, w), number(row, x), number(row, x + 1), number(row, x + 2));
  if (std::abs(rotation.norm() - 1.0) > kUnitTolerance) {
    complain(row, "the quaternion from column " + std::to_string(q + 1) + " has no unit length");
    return Rigid3::Identity();
  }
  Rigid3 T = Rigid3::Identity();
  T.linear() = rotation.normalized().toRotationMatrix();
  for (std::size_t i = 0; i < 3; ++i) T.translation()(static_cast<Eigen::Index>(i)) = number(row, column + i);
  return T;
}

Rigid3 TextTable::rigid_from_matrix(std::size_t row, std::size_t column) {
  Rigid3 T = Rigid3::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) T(r, c) = number(row, column + static_cast<std::size_t>(4 * r + c));
  }
  if (std::abs(T.linear().determinant() - 1.0) > kUnitTolerance) {
    complain(row, "the matrix from column " + std::to_string(column + 1) + " is no rotation");
    return Rigid3::Identity();
  }
  return orthonormalized(T);
}

}  // namespace pelorus
