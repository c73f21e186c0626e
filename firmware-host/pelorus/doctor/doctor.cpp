#include "firmware-host/pelorus/doctor/doctor.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "firmware-host/pelorus/doctor/checkup.h"
#include "firmware-host/runtime/config_loader.h"

namespace pelorus {
namespace {

constexpr int kNotReadyExitCode = 1;

struct DoctorArguments {
  std::vector<std::string> configs;
  bool json = false;
};

Result<int> run_doctor(const DoctorArguments& arguments) {
  ServiceConfig config;
  if (const Result<Ok> applied = apply_config_files(arguments.configs, config); !applied) return applied.error();
  CheckupOptions options;
  options.configured = !arguments.configs.empty();
  const std::vector<HostCheck> checks = check_host(config, HostFiles(), options);
  const std::string text = arguments.json ? checks_json(checks) + "\n" : checks_text(checks);
  std::fputs(text.c_str(), stdout);
  return count(checks, Verdict::fail) > 0 ? kNotReadyExitCode : 0;
}

}  // namespace

Verb add_doctor(CLI::App& app) {
  auto arguments = std::make_shared<DoctorArguments>();
  CLI::App* parser = app.add_subcommand("doctor", "Check this computer before a dive; changes nothing");
  parser
      ->add_option("--config", arguments->configs,
                   "Settings file of the service; several apply in turn. Without: the defaults, and no source")
      ->allow_extra_args(false);
  parser->add_flag("--json", arguments->json, "One JSON object in place of lines");
  parser->footer(
      "OK: as it should be. WARN: the service works, but worse than it could. FAIL: the dive would go wrong.\n"
      "Exit codes: 0 no FAIL, 1 at least one FAIL, 2 usage, 5 configuration, 6 a file cannot be read, or the\n"
      "output not be written.");
  return {parser, [arguments] { return run_doctor(*arguments); }};
}

}  // namespace pelorus
