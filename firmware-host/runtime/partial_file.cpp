#include "firmware-host/runtime/partial_file.h"

#include <cerrno>
#include <cstring>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

Error io_error(const fs::path& path, const std::string& what, const std::string& cure) {
  return {ErrorCode::io, path.string(), what, cure};
}

Result<> check_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code ignored;
  if (fs::is_directory(folder, ignored)) return Ok{};
  const std::string what = fs::exists(folder, ignored) ? " is no folder" : " does not exist";
  return io_error(path, "cannot be created: " + folder.string() + what, "make that folder, or check the path");
}

// The file that is to be replaced. Renaming over a device or a link would put a file in its place.
Result<fs::path> target_of(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status there = fs::status(path, ignored);
  if (fs::is_directory(there)) return io_error(path, "is a folder", "give the name of a file");
  if (fs::exists(there) && !fs::is_regular_file(there))
    return io_error(path, "is a device, a pipe or the like, which is not replaced", "give the name of a file");
  if (!fs::is_symlink(fs::symlink_status(path, ignored))) return path;
  if (!fs::exists(there)) return io_error(path, "is a link to nothing", "remove the link, or give another name");
  return fs::canonical(path, ignored);
}

}  // namespace

Result<PartialFile> PartialFile::create(const fs::path& path, bool overwrite) {
  Result<fs::path> target = target_of(path);
  if (!target) return target.error();
  std::error_code ignored;
  if (!overwrite && fs::exists(path, ignored)) {
    return io_error(path, "exists already", "choose another --out, or pass --overwrite");
  }
  if (const Result<> folder = check_folder_of(path); !folder) return folder.error();
  PartialFile file;
  file.path_ = std::move(target.value());
  file.file_.reset(std::fopen(file.partial().c_str(), "wb"));
  if (!file.file_) {
    return io_error(path, std::string("cannot be created: ") + std::strerror(errno), "check the folder and its rights");
  }
  return file;
}

PartialFile::~PartialFile() {
  if (!file_) return;
  file_.reset();
  std::error_code ignored;
  fs::remove(partial(), ignored);
}

void PartialFile::write(std::string_view bytes) {
  failed_ = failed_ || std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size();
}

Result<> PartialFile::flush() {
  failed_ = failed_ || std::fflush(file_.get()) != 0;
  if (!failed_) return Ok{};
  return io_error(path_, std::string("cannot be written: ") + std::strerror(errno), "free space on the device");
}

Result<> PartialFile::finish() {
  if (Result<> flushed = flush(); !flushed) return flushed;
  std::error_code error;
  fs::rename(partial(), path_, error);
  if (error)
    return io_error(path_, "cannot be put in its place: " + error.message(), "check the folder and its rights");
  file_.reset();
  return Ok{};
}

Result<> write_together(const std::vector<TextFile>& files, bool overwrite) {
  std::vector<PartialFile> written;
  for (const TextFile& file : files) {
    Result<PartialFile> partial = PartialFile::create(file.path, overwrite);
    if (!partial) return partial.error();
    written.push_back(std::move(partial.value()));
    written.back().write(file.text);
    if (Result<> flushed = written.back().flush(); !flushed) return flushed;
  }
  for (PartialFile& file : written) {
    if (Result<> finished = file.finish(); !finished) return finished;
  }
  return Ok{};
}

}  // namespace pelorus
