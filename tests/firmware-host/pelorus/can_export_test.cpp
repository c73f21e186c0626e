#include "firmware-host/pelorus/can/can_export.h"

#include <gtest/gtest.h>

#include "services/can/contract_text.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

TEST(CanExport, FilesOfTheTreeAreThoseOfTheContract) {
  const auto files = contract_files(PELORUS_SOURCE_DIR);
  ASSERT_TRUE(files.ok()) << files.error().message();
  for (const GeneratedFile& file : files.value()) {
    EXPECT_EQ(test::read_text(std::filesystem::path(PELORUS_SOURCE_DIR) / file.path), file.text)
        << file.path << " differs from services/can/can_contract.cpp: run `build/bin/pelorus can export`";
  }
}

TEST(CanExport, WritesTheFilesAndKeepsTheProseOfThePage) {
  const test::TemporaryFolder tree;
  std::filesystem::create_directories(tree.path() / "firmware-host/autopilot");
  const std::string prose = std::string("before\n") + kPageBegin + "\nold\n" + kPageEnd + "\nafter\n";
  test::write_text(tree.path() / "docs/can.md", prose);
  ASSERT_TRUE(export_contract(tree.path()).ok());
  const std::string page = test::read_text(tree.path() / "docs/can.md");
  EXPECT_TRUE(page.starts_with("before\n"));
  EXPECT_TRUE(page.ends_with("\nafter\n"));
  EXPECT_EQ(page.find("\nold\n"), std::string::npos);
  EXPECT_EQ(test::read_text(tree.path() / "firmware-host/autopilot/pelorus.dbc"), dbc_text(kCanDefaultBaseId));
}

TEST(CanExport, APageWithoutItsMarkersIsRefusedAndNothingIsWritten) {
  const test::TemporaryFolder tree;
  std::filesystem::create_directories(tree.path() / "firmware-host/autopilot");
  test::write_text(tree.path() / "docs/can.md", "no markers\n");
  const auto written = export_contract(tree.path());
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::bad_input);
  EXPECT_TRUE(std::filesystem::is_empty(tree.path() / "firmware-host/autopilot"));
}

}  // namespace
}  // namespace pelorus
