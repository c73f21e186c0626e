#pragma once
// The tool as a process of its own, and a scene small enough to run it often. For programs with PELORUS_TOOL defined.

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

#include "tests/support/temporary_folder.h"

namespace pelorus::test {

struct Outcome {
  int exit_code = 0;
  std::string text;  // stdout and stderr
};

// `before`: shell commands that come first.
inline Outcome run_tool(const std::string& arguments, const std::string& before = "") {
  Outcome outcome;
  const std::string command = before + PELORUS_TOOL + " " + arguments + " 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 512> part{};
  while (pipe && std::fgets(part.data(), part.size(), pipe)) outcome.text += part.data();
  const int status = pipe ? pclose(pipe) : -1;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

// A flat, small, quick scene of a few frames.
inline std::string small_scene(const TemporaryFolder& folder, int frames) {
  const std::string scene = (folder.path() / "scene.yaml").string();
  write_text(scene, "name: small\nframes: " + std::to_string(frames) +
                        "\n"
                        "camera: {width_px: 160, height_px: 120, f_px: 120, baseline_m: 0.12}\n"
                        "vehicle:\n  step_s: 1\n  p_m: [[0, 0, 0], [0.2, 0, 0], [0.4, 0, 0], [0.6, 0, 0]]\n"
                        "  rpy_deg: [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n");
  return scene;
}

}  // namespace pelorus::test
