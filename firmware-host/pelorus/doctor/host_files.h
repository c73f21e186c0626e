#pragma once
// HostFiles: what the kernel and the distribution tell in files, below a root that is "/" except in tests.
// Thread-safe; reads on every call.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pelorus {

class HostFiles {
 public:
  explicit HostFiles(std::filesystem::path root = "/") : root_(std::move(root)) {}

  // The file without blanks at its end; none when it cannot be read.
  [[nodiscard]] std::optional<std::string> text(const std::string& path) const;
  // None also when it is no whole number.
  [[nodiscard]] std::optional<long long> number(const std::string& path) const;
  // Paths (below the root, as given to text()) of the entries of a folder, sorted.
  [[nodiscard]] std::vector<std::string> entries(const std::string& folder) const;

 private:
  [[nodiscard]] std::filesystem::path below(const std::string& path) const;
  std::filesystem::path root_;
};

// Whether this process holds a capability, by its bit (linux/capability.h).
[[nodiscard]] bool holds_capability(const HostFiles& files, int bit);

}  // namespace pelorus
