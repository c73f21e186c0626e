#include "firmware-host/pelorus/synth/synth.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "firmware-host/pelorus/progress_bar.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"
#include "firmware-host/pelorus/synth/asl_writer.h"
#include "firmware-host/runtime/scene_lookup.h"

namespace pelorus {
namespace {

struct SynthOptions {
  std::string scene;
  std::string out;
  int frames = 0;
  std::uint64_t seed = 0;
  bool seed_given = false;
  int threads = 0;
  bool overwrite = false;
};

struct Sighting {
  int frames = 0;
  int first = -1;
  int last = -1;
};

// False: interrupted.
Result<bool> render_all(synthetic::SyntheticSource& source, AslWriter& writer, std::vector<Sighting>& sightings,
                        ProgressBar& bar) {
  SourcePair pair;
  for (int frame = 0; frame < source.scene().frames; ++frame) {
    if (ReplayInterrupt::requested()) return false;
    source.render(frame, pair);
    Result<> written = writer.append(frame, pair, source);
    if (!written) return written.error();
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      if (source.visible_px(static_cast<int>(k)) == 0) continue;
      ++sightings[k].frames;
      if (sightings[k].first < 0) sightings[k].first = frame;
      sightings[k].last = frame;
    }
    bar.update(static_cast<std::size_t>(frame) + 1);
  }
  if (Result<> finished = writer.finish(); !finished) return finished.error();
  return true;
}

Result<int> run_synth(const SynthOptions& options) {
  Result<std::string> path = find_scene(options.scene);
  if (!path) return path.error();
  Result<synthetic::Scene> scene = synthetic::load_scene(path.value());
  if (!scene) return scene.error();
  if (options.frames > 0) scene.value().frames = options.frames;
  if (options.seed_given) scene.value().reseed(options.seed);
  synthetic::SyntheticSource source(scene.value(), options.threads);
  Result<AslWriter> writer = AslWriter::open(options.out, options.overwrite, source);
  if (!writer) return writer.error();

  std::printf("%s\n", source.description().c_str());
  std::fflush(stdout);
  ProgressBar bar("rendering", source.pair_count(), "pairs");
  std::vector<Sighting> sightings(static_cast<std::size_t>(source.object_count()));
  const ReplayInterrupt interrupt;
  Result<bool> rendered = render_all(source, writer.value(), sightings, bar);
  bar.clear();
  if (!rendered) return rendered.error();
  if (!rendered.value()) {
    std::fprintf(stderr, "pelorus: interrupted; an unfinished dive is not kept\n");
    return kInterruptedExitCode;
  }
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    const Sighting& seen = sightings[k];
    const std::string& name = source.object_body(static_cast<int>(k)).name;
    std::printf("object%zu %s: in view in %d frame%s", k + 1, name.c_str(), seen.frames, seen.frames == 1 ? "" : "s");
    if (seen.frames > 0) std::printf(" (%d to %d)", seen.first, seen.last);
    std::printf("\n");
  }
  std::printf("%s written to %s in %.1f s, %.1f pairs/s\n",
              pairs_text(static_cast<std::size_t>(source.scene().frames)).c_str(), options.out.c_str(), bar.elapsed_s(),
              source.scene().frames / bar.elapsed_s());
  return 0;
}

}  // namespace

Verb add_synth(CLI::App& app) {
  auto options = std::make_shared<SynthOptions>();
  CLI::App* parser = app.add_subcommand("synth", "Render a synthetic dive with exact truth (EuRoC ASL folder)");
  parser
      ->add_option("SCENE", options->scene,
                   "Scene file, or the name of a shipped scene: paper, static, "
                   "appear_occlude_stop, large_body, abreast, turbid, turbid_static, five, shapes")
      ->required();
  parser->add_option("--out", options->out, "Folder to write; absent or empty, or see --overwrite")
      ->required()
      ->type_name("DIR");
  parser->add_option("--frames", options->frames, "Number of stereo pairs (default: the scene's)")
      ->check(count_above_zero());
  CLI::Option* seed =
      parser->add_option("--seed", options->seed, "Another world of the same kind (default: the scene's)")
          ->check(whole_from_zero());
  parser->add_option("--threads", options->threads, "Threads to render with (default: all); never changes the result")
      ->check(CLI::Range(1, 256));
  parser->add_flag("--overwrite", options->overwrite, "Replace an earlier synthetic dive in DIR");
  // Its earlier name: an empty group keeps it out of the help.
  parser->add_flag("--force", options->overwrite)->group("");
  parser->footer(
      "Example: pelorus synth paper --out /tmp/dive\n"
      "Truth: mav0/state_groundtruth_estimate0 (vehicle; T_BS: cameras in it), mav0/object<k> (moving bodies).\n"
      "Exit codes: 0 done, 2 usage, 5 scene file, 6 input/output, 130 interrupted.");
  return {parser, [options, seed] {
            options->seed_given = seed->count() > 0;
            return run_synth(*options);
          }};
}

}  // namespace pelorus
