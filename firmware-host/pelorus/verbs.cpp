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

std::string first_unknown(const CLI::App& app) {
  for (const std::string& word : app.remaining()) {
    if (word != "--") return word;
  }
  return "";
}

// CLI11's words for what is wrong, in the form of our own errors, of the verb (of a verb) that it is wrong in. CLI11
// does not name an unknown verb by itself, and of an unknown option only when nothing else is wrong.
std::string usage_text(const CLI::App* app, const CLI::Error& error) {
  std::string command = "pelorus";
  std::string unknown = first_unknown(*app);
  while (unknown.empty() && !app->get_subcommands().empty()) {
    app = app->get_subcommands().front();
    command += " " + app->get_name();
    unknown = first_unknown(*app);
  }
  std::string what = error.what();
  if (!unknown.empty() && unknown.front() == '-') {
    what = "'" + unknown + "' is no option of " + command;
  } else if (app->get_subcommands().empty() && app->get_require_subcommand_min() > 0) {
    what = unknown.empty() ? "no verb is given" : "'" + unknown + "' is no verb of " + command;
  } else if (!unknown.empty()) {
    what = "'" + unknown + "' is not expected";
  }
  return "pelorus: " + what + " (" + command + " --help tells what there is)\n";
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
