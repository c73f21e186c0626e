// pelorus: the tool. Parses the verb, runs it, turns an Error into one line on stderr and an exit code.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <vector>

#include "firmware-host/pelorus/bench/bench.h"
#include "firmware-host/pelorus/calib.h"
#include "firmware-host/pelorus/can/can.h"
#include "firmware-host/pelorus/command.h"
#include "firmware-host/pelorus/demo.h"
#include "firmware-host/pelorus/doctor/doctor.h"
#include "firmware-host/pelorus/eval/ablate.h"
#include "firmware-host/pelorus/eval/eval.h"
#include "firmware-host/pelorus/export/export.h"
#include "firmware-host/pelorus/replay/replay.h"
#include "firmware-host/pelorus/report/report.h"
#include "firmware-host/pelorus/synth/synth.h"
#ifdef PELORUS_WITH_LCM
#include "firmware-host/pelorus/top/top.h"
#endif

namespace {

int run_tool(int argc, char** argv) {
  CLI::App app{"Pelorus: the vehicle's motion and the tracks of moving rigid bodies from stereo."};
  app.set_version_flag("--version", "pelorus " PELORUS_VERSION);
  app.require_subcommand(1);
  std::vector<pelorus::Verb> verbs;
  verbs.push_back(pelorus::add_bench(app));
  verbs.push_back(pelorus::add_calib(app));
  verbs.push_back(pelorus::add_can(app));
  verbs.push_back(pelorus::add_demo(app));
  verbs.push_back(pelorus::add_doctor(app));
  verbs.push_back(pelorus::add_replay(app));
  verbs.push_back(pelorus::add_eval(app));
  verbs.push_back(pelorus::add_report(app));
  verbs.push_back(pelorus::add_ablate(app));
  verbs.push_back(pelorus::add_export(app));
  verbs.push_back(pelorus::add_synth(app));
#ifdef PELORUS_WITH_LCM
  verbs.push_back(pelorus::add_top(app));
#endif
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : pelorus::exit_code(pelorus::ErrorCode::bad_usage);
  }
  for (const pelorus::Verb& verb : verbs) {
    if (!verb.parser->parsed()) continue;
    const pelorus::Result<int> outcome = verb.run();
    if (outcome.ok()) return outcome.value();
    std::fprintf(stderr, "pelorus: %s\n", outcome.error().message().c_str());
    return pelorus::exit_code(outcome.error().code);
  }
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_tool(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "pelorus: unexpected failure: %s\n", e.what());
    return 1;
  }
}
