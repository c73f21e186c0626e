#pragma once
// Writes a synthetic dive as an EuRoC ASL folder: mav0/cam0, mav0/cam1 (data.csv, sensor.yaml, data/<ns>.png),
// mav0/state_groundtruth_estimate0 (T_world_body: the vehicle, x forward, y starboard, z down, in which T_BS has the
// cameras as the scene mounts them) and, per moving body k = 1, 2, ..., mav0/object<k>/data.csv (T_world_obj,
// visible_px) and body.csv (name, box); goals.yaml when the scene has goals. `world` is the left camera of frame 0.
// Nothing bears the final name before everything is written, and a dive that is not finished leaves nothing behind.
// Thread-bound.

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "drivers/synthetic/synthetic_source.h"

namespace pelorus {

// Whether this writer wrote the folder `mav0`: its sensor.yaml says so.
[[nodiscard]] bool is_synthetic_dive(const std::filesystem::path& mav0);

class AslWriter {
 public:
  // Work goes to `<folder>.partial`. An existing, non-empty folder is an error unless `replace`.
  [[nodiscard]] static Result<AslWriter> open(const std::filesystem::path& folder, bool replace,
                                              const synthetic::SyntheticSource& source);
  // The pair rendered last by the source, with its truth.
  [[nodiscard]] Result<> append(int frame, const SourcePair& pair, const synthetic::SyntheticSource& source);
  // Gives the folder its name.
  [[nodiscard]] Result<> finish();

 private:
  AslWriter(std::filesystem::path folder, bool replace);
  struct RemoveFolder {
    void operator()(const std::filesystem::path* folder) const;
  };
  [[nodiscard]] Result<> write_headers(const synthetic::SyntheticSource& source);
  [[nodiscard]] Result<> write_goals(const synthetic::Goals& goals);
  [[nodiscard]] Result<> write_camera(int side, const StereoCalibration& calibration, double rate_hz);

  std::filesystem::path folder_;
  // Removed, with what it holds, unless it got its final name.
  std::unique_ptr<const std::filesystem::path, RemoveFolder> partial_;
  bool replace_;
  std::ofstream lists_[2];
  std::ofstream vehicle_truth_;
  std::vector<std::ofstream> object_truth_;
};

}  // namespace pelorus
