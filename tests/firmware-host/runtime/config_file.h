#pragma once
// A configuration file made up by a test, and what the loader says of it.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "firmware-host/runtime/config_loader.h"
#include "tests/support/temporary_folder.h"

namespace pelorus::test {

class ConfigFile : public ::testing::Test {
 protected:
  Result<Ok> apply(const std::string& text) {
    write_text(path_, text);
    return apply_config_files({path_.string()}, config_);
  }
  std::string problems_of(const std::string& text) {
    const Result<Ok> outcome = apply(text);
    return outcome ? "none" : outcome.error().message();
  }
  std::string line(int number) const { return path_.string() + ":" + std::to_string(number) + ":"; }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "p.yaml";
  PipelineConfig config_;
};

}  // namespace pelorus::test
