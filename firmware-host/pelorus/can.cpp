#include "firmware-host/pelorus/can.h"

#include <cstdio>
#include <memory>
#include <string>

#include "firmware-host/pelorus/can_export.h"
#include "services/can/contract_text.h"

namespace pelorus {
namespace {

struct CanArguments {
  std::string tree = ".";
  std::uint32_t base_id = kCanDefaultBaseId;
};

CLI::Option* add_base_id(CLI::App* parser, std::uint32_t& base_id) {
  return parser->add_option("--base-id", base_id, "First of the identifiers, as set in the configuration")
      ->check(CLI::Range(0U, 0x7FFU - kCanIdsUsed + 1))
      ->capture_default_str();
}

Result<int> run_export(const CanArguments& arguments) {
  if (auto written = export_contract(arguments.tree); !written) return written.error();
  return 0;
}

Result<int> run_dbc(const CanArguments& arguments) {
  std::fputs(dbc_text(arguments.base_id).c_str(), stdout);
  return 0;
}

}  // namespace

Verb add_can(CLI::App& app) {
  CLI::App* parser = app.add_subcommand("can", "Decode the CAN frames, or write the contract out");
  parser->require_subcommand(1);
  auto arguments = std::make_shared<CanArguments>();
  CLI::App* dbc = parser->add_subcommand("dbc", "Print the DBC of the contract");
  add_base_id(dbc, arguments->base_id);
  CLI::App* exporter = parser->add_subcommand("export", "Write the files made from the contract into a source tree");
  exporter->add_option("--tree", arguments->tree, "Root of the sources")->capture_default_str();
  return {parser, [dbc, arguments] { return dbc->parsed() ? run_dbc(*arguments) : run_export(*arguments); }};
}

}  // namespace pelorus
