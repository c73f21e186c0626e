#pragma once
// Writes what is generated from the CAN contract into a source tree: DBC, C header, test vectors, tables of the page.

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace pelorus {

struct GeneratedFile {
  std::filesystem::path path;  // from the root of the tree
  std::string text;
};

// What the files under `tree` should hold; docs/can.md keeps its prose and gets new tables between its markers.
// Errors: io (page missing), bad_input (markers missing).
[[nodiscard]] Result<std::vector<GeneratedFile>> contract_files(const std::filesystem::path& tree);

// Writes them, each under a temporary name first.
[[nodiscard]] Result<> export_contract(const std::filesystem::path& tree);

}  // namespace pelorus
