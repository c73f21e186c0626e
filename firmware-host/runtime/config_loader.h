#pragma once
// Reads configuration files (YAML) into the settings of pipeline and service. Strict: an unknown key, a wrong type, a
// value out of range or a key given twice is a problem, and all problems of a file are reported together, each with
// file:line and its cure. Files may list only the settings they change (overlays such as a bench set-up).
// Keys: config_fields.h. Thread-bound; reads one file.

#include <filesystem>

#include "core/base/result.h"
#include "core/pipeline/config.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

// Applies the file on top of `config`, which stays as it was when there is any problem.
// Errors: io (no such file), bad_configuration (everything else).
[[nodiscard]] Result<Ok> apply_config_file(const std::filesystem::path& file, ServiceConfig& config);
// The same for programs that only need the pipeline: settings of the service are checked, then left alone.
[[nodiscard]] Result<Ok> apply_config_file(const std::filesystem::path& file, PipelineConfig& config);

}  // namespace pelorus
