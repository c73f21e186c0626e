#pragma once
// TextTable: a file of rows of numbers and words (CSV, TUM, KITTI), each field checked when it is asked for; what is
// wrong is an Error with file:line. Lines that are empty or start with # are skipped; the first of the latter may name
// the columns. Thread-bound; holds the whole file.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/time.h"
#include "core/geometry/transform.h"

namespace pelorus {

enum class TableHeader { none, first_line };

// A last line without its end: the file was cut off. Of a run that was killed it is left away.
enum class CutLine { refuse, leave_away };

class TextTable {
 public:
  // Fields are parted by commas or runs of blanks. Every row must have as many fields as the header or, without one,
  // as the first row: a shorter last row is a file that was cut off.
  [[nodiscard]] static Result<TextTable> read(const std::filesystem::path& file, TableHeader header,
                                              CutLine cut_line = CutLine::refuse);
  // Of a run's own files: as the IncompleteMark beside them says.
  [[nodiscard]] static Result<TextTable> read_of_run(const std::filesystem::path& file, TableHeader header);

  // Without even a header: a file that was cut off there.
  [[nodiscard]] bool blank() const { return columns_ == 0; }

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  // Index of a named column.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;

  // The first problem met by number(), integer(), rigid() so far; they return 0 or the identity on a problem, so that
  // a row can be read through and judged once.
  [[nodiscard]] const std::optional<Error>& problem() const { return problem_; }
  double number(std::size_t row, std::size_t column);
  std::int64_t integer(std::size_t row, std::size_t column);
  // Seconds with a fraction, exact to the nanosecond.
  Timestamp time_of_seconds(std::size_t row, std::size_t column);
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const;
  // x y z, then a unit quaternion in the order that `w_first` says.
  Rigid3 rigid(std::size_t row, std::size_t column, bool w_first);
  // The top three rows of a 4x4 matrix, row by row (KITTI).
  Rigid3 rigid_from_matrix(std::size_t row, std::size_t column);
  // Notes a problem of the reader's own with a row.
  void complain(std::size_t row, const std::string& detail);

 private:
  struct Row {
    int line = 0;
    std::vector<std::string> fields;
  };
  std::filesystem::path file_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
  std::size_t columns_ = 0;
  std::optional<Error> problem_;
};

}  // namespace pelorus
