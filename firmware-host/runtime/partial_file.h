#pragma once
// PartialFile: a file that gets its name when it is whole: written beside it as NAME.partial, renamed by finish(),
// removed when it is given up. Thread-bound.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "core/base/result.h"

namespace pelorus {

class PartialFile {
 public:
  // Refuses a name that is taken, unless `overwrite`.
  [[nodiscard]] static Result<PartialFile> create(const std::filesystem::path& path, bool overwrite);
  PartialFile(PartialFile&&) = default;
  PartialFile& operator=(PartialFile&&) = delete;
  ~PartialFile();

  void write(std::string_view bytes);  // failure shows in flush() and finish()
  // Everything written is the kernel's.
  [[nodiscard]] Result<> flush();
  [[nodiscard]] Result<> finish();

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  PartialFile() = default;
  [[nodiscard]] std::filesystem::path partial() const { return path_.string() + ".partial"; }

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  bool failed_ = false;
};

}  // namespace pelorus
