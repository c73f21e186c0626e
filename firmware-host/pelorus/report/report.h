#pragma once
// `pelorus report`: one self-contained HTML page of a run: what moved where, how well, how fast. What `pelorus demo`
// ends with.

#include <filesystem>
#include <optional>
#include <string>

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// The page of the run in `folder` into `file`; an empty `dataset` leaves out what needs truth. Returns what makes the
// truth doubtful (truth_doubt), which the page says too.
[[nodiscard]] Result<std::optional<std::string>> write_report(const std::filesystem::path& folder,
                                                              const std::string& dataset,
                                                              const std::string& calibration_file,
                                                              const std::filesystem::path& file);

// Exit codes: 0 done; 2 usage; 3 bad input, or built without the page, or the page is of an INCOMPLETE run;
// 4 calibration; 6 output.
[[nodiscard]] Verb add_report(CLI::App& app);

}  // namespace pelorus
