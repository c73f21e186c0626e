#include "firmware-host/pelorus/export/export.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "firmware-host/pelorus/export/mcap_export.h"
#include "firmware-host/pelorus/export/ply_text.h"
#include "firmware-host/pelorus/export/trajectory_text.h"
#include "firmware-host/pelorus/results/incomplete_mark.h"
#include "firmware-host/pelorus/results/result_reader.h"
#include "firmware-host/runtime/partial_file.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  std::string run;
  std::string format;
  std::string out;
  int body = 0;
  bool overwrite = false;
};

fs::path default_path(const ExportArguments& arguments) {
  const fs::path folder(arguments.run);
  if (arguments.format == "mcap") return folder / "run.mcap";
  if (arguments.format == "csv") return folder / "trajectories.csv";
  const std::string whose = arguments.body > 0 ? "body_" + std::to_string(arguments.body) : std::string("camera");
  return folder / (whose + (arguments.format == "kitti" ? ".kitti.txt" : ".export.tum"));
}

// TUM or KITTI of one trajectory.
Result<> export_trajectory(const ExportArguments& arguments, const EstimatedRun& run, const fs::path& path) {
  std::optional<BodyId> body;
  if (arguments.body > 0) body = BodyId{arguments.body};
  const std::vector<TimedPose> poses = poses_of(run, body);
  if (poses.empty()) {
    return Error{ErrorCode::bad_input, arguments.run,
                 body ? "has no body " + std::to_string(arguments.body) : "has no frame with a pose",
                 body ? "objects.csv lists the numbers" : "see the states in frames.csv"};
  }
  if (arguments.format == "tum") return write_together({{path, tum_text(poses)}}, arguments.overwrite);
  return write_together({{path, kitti_text(poses)}, {path.string() + ".times", kitti_times_text(poses)}},
                        arguments.overwrite);
}

// scene.ply and a body_N.ply each, or one body's alone.
Result<int> export_clouds(const ExportArguments& arguments) {
  const Result<std::vector<ScenePoint>> points = read_points(arguments.run);
  if (!points) return points.error();
  std::vector<BodyId> bodies = bodies_of(points.value());
  if (arguments.body > 0) std::erase_if(bodies, [&](BodyId body) { return body != BodyId{arguments.body}; });
  if (bodies.empty()) {
    return arguments.body > 0
               ? Error{ErrorCode::bad_input, arguments.run, "has no points of a body " + std::to_string(arguments.body),
                       "objects.csv lists the numbers"}
               : Error{ErrorCode::bad_input, arguments.run, "has no points.csv, or none in it",
                       "replay the recording again: older runs have none"};
  }
  const fs::path folder = arguments.out.empty() ? fs::path(arguments.run) : fs::path(arguments.out);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{ErrorCode::io, folder.string(), "cannot create: " + error.message(), "check its rights"};
  std::vector<TextFile> files;
  for (const BodyId body : bodies) {
    const std::string name = body == kWorldBody ? "scene.ply" : "body_" + std::to_string(body.value) + ".ply";
    files.push_back({folder / name, ply_text(points.value(), body)});
  }
  if (const Result<> done = write_together(files, arguments.overwrite); !done) return done.error();
  for (const TextFile& file : files) std::printf("%s\n", file.path.c_str());
  return done_exit_code(arguments.run);
}

Result<int> run_export(const ExportArguments& arguments) {
  std::fputs(incomplete_warning(arguments.run).c_str(), stderr);
  if (arguments.format == "ply") return export_clouds(arguments);
  if (arguments.body > 0 && arguments.format != "tum" && arguments.format != "kitti") {
    return Error{ErrorCode::bad_usage, "--body", "is for tum, kitti and ply, which can hold one body alone",
                 "leave it out: csv and mcap hold all bodies"};
  }
  std::string cut;
  const Result<EstimatedRun> run = read_run(arguments.run, &cut);
  if (!run) return run.error();
  if (!cut.empty()) std::fprintf(stderr, "pelorus: warning: %s: %s\n", arguments.run.c_str(), cut.c_str());
  if (run.value().empty()) return Error{ErrorCode::bad_input, arguments.run, "the run has no frames", ""};
  const fs::path path = arguments.out.empty() ? default_path(arguments) : fs::path(arguments.out);
  const Result<> done = arguments.format == "mcap" ? export_mcap(run.value(), path, arguments.overwrite)
                        : arguments.format == "csv"
                            ? write_together({{path, csv_text(run.value())}}, arguments.overwrite)
                            : export_trajectory(arguments, run.value(), path);
  if (!done) return done.error();
  std::printf("%s\n", path.c_str());
  return done_exit_code(arguments.run);
}

}  // namespace

Verb add_export(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* parser = app.add_subcommand("export", "A run's results in the formats of other tools");
  parser->add_option("OUT", arguments->run, "The output folder of `pelorus replay`")->required();
  parser
      ->add_option("--format", arguments->format,
                   "tum, kitti (poses, and PATH.times), csv (camera and bodies), mcap,\n"
                   "ply (point clouds: the scene, and each body in its own frame)")
      ->required()
      ->check(one_of({"tum", "kitti", "csv", "mcap", "ply"}));
  parser->add_option("--out", arguments->out, "File to write (ply: folder); without: a name by the format in OUT");
  parser
      ->add_option("--body", arguments->body,
                   "tum, kitti: this body's trajectory in place of the camera's; ply: its points alone")
      ->check(count_above_zero());
  parser->add_flag("--overwrite", arguments->overwrite, "Replace a file of that name");
  parser->footer(
      "Exit codes: 0 written, 2 usage, 3 no run or nothing in it to write, or written from an INCOMPLETE run,\n"
      "6 input/output.");
  return {parser, [arguments] { return run_export(*arguments); }};
}

}  // namespace pelorus
