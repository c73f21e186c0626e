#include "firmware-host/pelorus/can/can.h"

#include <cstdio>
#include <memory>
#include <string>

#include "firmware-host/pelorus/can/can_dump.h"
#include "firmware-host/pelorus/can/can_export.h"
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
  auto dump_options = std::make_shared<CanDumpOptions>();
  CLI::App* dump = parser->add_subcommand("dump", "Decode frames of an interface or of a candump log");
  dump->add_option("SOURCE", dump_options->source, "Interface (can0), log of candump -l or -L, or - for a log on stdin")
      ->required();
  dump->add_flag("--sets", dump_options->sets, "One line per estimate, as the autopilot's receiver hands it out");
  dump->add_flag("--json", dump_options->json, "One JSON object per line");
  dump->add_option("--seconds", dump_options->seconds, "Interface: end after so long")->check(above_zero());
  dump->add_option("--count", dump_options->count, "End after so many lines")->check(count_above_zero());
  add_base_id(dump, dump_options->base_id);
  dump->footer(
      "Exit codes: 0 done, 2 usage, 3 lines that are none of candump, or no whole frame, 6 input/output, 7 no such "
      "interface.");
  auto arguments = std::make_shared<CanArguments>();
  CLI::App* dbc = parser->add_subcommand("dbc", "Print the DBC of the contract");
  add_base_id(dbc, arguments->base_id);
  CLI::App* exporter = parser->add_subcommand("export", "Write the files made from the contract into a source tree");
  exporter->add_option("--tree", arguments->tree, "Root of the sources")->capture_default_str();
  dbc->footer("Exit codes: 0 done, 2 usage, 6 output.");
  exporter->footer("Exit codes: 0 done, 2 usage, 3 the page lacks its markers, 6 input/output.");
  return {parser, [dump, dbc, dump_options, arguments] {
            if (dump->parsed()) return run_can_dump(*dump_options);
            return dbc->parsed() ? run_dbc(*arguments) : run_export(*arguments);
          }};
}

}  // namespace pelorus
