#include "firmware-host/pelorus/can/can_export.h"

#include <fstream>
#include <iterator>
#include <utility>

#include "services/can/contract_text.h"

namespace pelorus {
namespace {

Result<std::string> read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return Error{ErrorCode::io, path.string(), "cannot be read", "--tree is the root of the sources"};
  return std::string(std::istreambuf_iterator<char>(in), {});
}

Result<std::string> page_with_new_tables(const std::filesystem::path& page) {
  auto text = read_text(page);
  if (!text) return text;
  const std::size_t begin = text.value().find(kPageBegin);
  const std::size_t end = text.value().find(kPageEnd);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    return Error{ErrorCode::bad_input, page.string(), "the markers of the generated part are gone",
                 std::string("put back '") + kPageBegin + "' and '" + kPageEnd + "'"};
  const std::size_t rest = text.value().find('\n', end);
  const std::string after = rest == std::string::npos ? "" : text.value().substr(rest + 1);
  return text.value().substr(0, begin) + page_tables_text() + after;
}

Result<> write_text(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::path part = path;
  part += ".part";
  {
    std::ofstream out(part, std::ios::binary);
    out << text;
    if (!out.flush()) return Error{ErrorCode::io, part.string(), "cannot be written", ""};
  }
  std::error_code failure;
  std::filesystem::rename(part, path, failure);
  if (failure) return Error{ErrorCode::io, path.string(), failure.message(), ""};
  return Ok{};
}

}  // namespace

Result<std::vector<GeneratedFile>> contract_files(const std::filesystem::path& tree) {
  const std::filesystem::path page = "docs/can.md";
  const std::filesystem::path receiver = "firmware-host/autopilot";
  auto page_text = page_with_new_tables(tree / page);
  if (!page_text) return page_text.error();
  return std::vector<GeneratedFile>{
      {receiver / "pelorus.dbc", dbc_text(kCanDefaultBaseId)},
      {receiver / "pelorus_can_contract.h", c_header_text()},
      {receiver / "vectors_classic.log", vectors_log_text(CanTransport::classic)},
      {receiver / "vectors_fd.log", vectors_log_text(CanTransport::fd)},
      {page, page_text.value()},
  };
}

Result<> export_contract(const std::filesystem::path& tree) {
  const auto files = contract_files(tree);
  if (!files) return files.error();
  for (const GeneratedFile& file : files.value()) {
    if (auto written = write_text(tree / file.path, file.text); !written) return written;
  }
  return Ok{};
}

}  // namespace pelorus
