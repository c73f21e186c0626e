#pragma once
// PartialFile: a file that gets its name when it is whole: written beside it as NAME.partial, renamed by finish(),
// removed when it is given up. A link keeps its place, its target is what is replaced; a device, a pipe or the like is
// never replaced. Thread-bound.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace pelorus {

class PartialFile {
 public:
  // Refuses a name that is taken, unless `overwrite`, and one that no file can have; the error says why.
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

struct TextFile {
  std::filesystem::path path;
  std::string text;
};

// None of the files gets its name before all are written. They get their names one after the other: should that fail
// for one of them (rights or folder changed meanwhile), those before it are in their places already.
[[nodiscard]] Result<> write_together(const std::vector<TextFile>& files, bool overwrite);

}  // namespace pelorus
