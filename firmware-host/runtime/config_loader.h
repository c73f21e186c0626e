#pragma once
// Reads configuration files (YAML) into the settings of pipeline and service. Strict: an unknown key, a wrong type, a
// value out of range or a key given twice is a problem, and all problems of all files are reported together, each with
// file:line and its cure. Files may list only the settings they change (overlays such as a bench set-up); rules between
// settings are judged once, on what all files together make. Keys: config_fields.h. Thread-bound; reads the files.

#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/pipeline/config.h"
#include "firmware-host/runtime/config_fields.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

// More rules than those of config_conflicts and service_conflicts: what a program needs beside. Judged when all else is
// in order: a key that is mistyped is not missing too.
using ConfigRules = std::function<std::vector<ConfigConflict>(const ServiceConfig&)>;

// Applies the files in turn on top of `config`, which stays as it was when there is any problem.
// Errors: io (a file cannot be read), bad_configuration (everything else).
[[nodiscard]] Result<Ok> apply_config_files(const std::vector<std::string>& files, ServiceConfig& config,
                                            const ConfigRules& more = {});
// The same for programs that only need the pipeline: settings of the service are checked, then left alone.
[[nodiscard]] Result<Ok> apply_config_files(const std::vector<std::string>& files, PipelineConfig& config);

}  // namespace pelorus
