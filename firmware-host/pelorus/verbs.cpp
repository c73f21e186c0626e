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

std::vector<Verb> add_verbs(CLI::App& app) {
  app.description("Pelorus: the vehicle's motion and the tracks of moving rigid bodies from stereo.");
  app.set_version_flag("--version", "pelorus " PELORUS_VERSION);
  app.require_subcommand(1);
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
