#include "firmware-host/pelorus/verbs.h"

#include "firmware-host/pelorus/bench/bench.h"
#include "firmware-host/pelorus/calib.h"
#include "firmware-host/pelorus/can/can.h"
#include "firmware-host/pelorus/demo.h"
#include "firmware-host/pelorus/doctor/doctor.h"
#include "firmware-host/pelorus/eval/ablate.h"
#include "firmware-host/pelorus/eval/eval.h"
#include "firmware-host/pelorus/export/export.h"
#include "firmware-host/pelorus/replay/replay.h"
#include "firmware-host/pelorus/report/report.h"
#include "firmware-host/pelorus/synth/synth.h"
#ifdef PELORUS_WITH_LCM
#include "firmware-host/pelorus/command/service_command.h"
#include "firmware-host/pelorus/top/top.h"
#endif

namespace pelorus {

namespace {

// CLI11's words for what is wrong, in the form of our own errors; it does not tell the unknown verb by itself.
std::string usage_text(const CLI::App* app, const CLI::Error& error) {
  const std::vector<std::string> unknown = app->remaining(true);
  const bool no_verb = app->get_subcommands().empty();
  const std::string what = !no_verb          ? error.what()
                           : unknown.empty() ? "no verb is given"
                                             : "'" + unknown.front() + "' is no verb";
  const std::string verb = no_verb ? "" : " " + app->get_subcommands().front()->get_name();
  return "pelorus: " + what + " (pelorus" + verb + " --help tells what there is)\n";
}

}  // namespace

std::vector<Verb> add_verbs(CLI::App& app) {
  app.description("Pelorus: the vehicle's motion and the tracks of moving rigid bodies from stereo.");
  app.set_version_flag("--version", "pelorus " PELORUS_VERSION);
  app.require_subcommand(1);
  app.failure_message(usage_text);
  std::vector<Verb> verbs;
  verbs.push_back(add_bench(app));
  verbs.push_back(add_calib(app));
  verbs.push_back(add_can(app));
#ifdef PELORUS_WITH_LCM
  verbs.push_back(add_command(app));
#endif
  verbs.push_back(add_demo(app));
  verbs.push_back(add_doctor(app));
  verbs.push_back(add_replay(app));
  verbs.push_back(add_eval(app));
  verbs.push_back(add_report(app));
  verbs.push_back(add_ablate(app));
  verbs.push_back(add_export(app));
  verbs.push_back(add_synth(app));
#ifdef PELORUS_WITH_LCM
  verbs.push_back(add_top(app));
#endif
  return verbs;
}

}  // namespace pelorus
