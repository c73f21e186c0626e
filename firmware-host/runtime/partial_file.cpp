#include "firmware-host/runtime/partial_file.h"

#include <cerrno>
#include <cstring>

namespace pelorus {
namespace {

Error io_error(const std::filesystem::path& path, const std::string& what, const std::string& cure) {
  return {ErrorCode::io, path.string(), what, cure};
}

}  // namespace

Result<PartialFile> PartialFile::create(const std::filesystem::path& path, bool overwrite) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return io_error(path, "is a folder", "give --out a file");
  if (!overwrite && std::filesystem::exists(path, ignored)) {
    return io_error(path, "exists already", "choose another --out, or pass --overwrite");
  }
  PartialFile file;
  file.path_ = path;
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
  std::filesystem::remove(partial(), ignored);
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
  std::filesystem::rename(partial(), path_, error);
  if (error)
    return io_error(path_, "cannot be put in its place: " + error.message(), "check the folder and its rights");
  file_.reset();
  return Ok{};
}

}  // namespace pelorus
