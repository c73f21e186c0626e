// write_manual FOLDER: writes the manual pages and the completions of the programs into the folder, at build time.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "firmware-host/manual/bash_completion.h"
#include "firmware-host/manual/man_page.h"
#include "firmware-host/pelorus/verbs.h"
#ifdef PELORUS_WITH_LCM
#include "firmware-host/pelorusd/service_arguments.h"
#endif

namespace {

namespace fs = std::filesystem;

bool write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (out.good()) return true;
  std::fprintf(stderr, "write_manual: %s: cannot be written\n", file.c_str());
  return false;
}

bool write_program(const fs::path& folder, const CLI::App& parser, const pelorus::ManualFacts& facts) {
  bool good = write(folder / "completions" / facts.program, pelorus::bash_completion(parser, facts.program));
  for (const pelorus::ManPage& page : pelorus::man_pages(parser, facts)) {
    good = write(folder / ("man" + facts.section) / page.file_name, page.text) && good;
  }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_manual FOLDER\n");
    return 2;
  }
  const fs::path folder = argv[1];
  std::error_code error;
  fs::remove_all(folder, error);  // a verb that went leaves no page behind
  for (const char* part : {"man1", "man8", "completions"}) {
    fs::create_directories(folder / part, error);
    if (!error) continue;
    std::fprintf(stderr, "write_manual: %s: %s\n", (folder / part).c_str(), error.message().c_str());
    return 1;
  }
  CLI::App tool;
  const auto verbs = pelorus::add_verbs(tool);
  bool good = write_program(folder, tool, {"pelorus", "1", PELORUS_VERSION, "\\fBpelorusd\\fR(8)"});
#ifdef PELORUS_WITH_LCM
  CLI::App service;
  pelorus::ServiceArguments arguments;
  pelorus::add_service_arguments(service, arguments);
  good = write_program(folder, service, {"pelorusd", "8", PELORUS_VERSION, "\\fBpelorus\\fR(1)"}) && good;
#endif
  return good ? 0 : 1;
}
