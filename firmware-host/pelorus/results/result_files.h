#pragma once
// ResultWriter: what a run leaves on disk (interfaces: camera.tum, objects.csv, frames.csv) for `pelorus eval`.
// The three files hold nothing that depends on the machine's speed, so that the same input gives the same bytes;
// wall times go to timing.csv. Every frame is handed to the kernel before append() returns: an error or a signal
// later loses nothing already written. Frames and units: the column names; transforms as in FrameResult.
// Thread-bound. One per output folder.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/model/stage_data.h"

namespace pelorus {

// Wall times of one frame around the step [us].
struct FrameTiming {
  std::int64_t read_us = 0;     // decoding from the source
  std::int64_t rectify_us = 0;  // 0 when the images came rectified
  std::int64_t step_us = 0;     // Pipeline::step
};

struct ResultPaths {
  explicit ResultPaths(const std::filesystem::path& folder)
      : camera(folder / "camera.tum"),
        objects(folder / "objects.csv"),
        frames(folder / "frames.csv"),
        timing(folder / "timing.csv"),
        points(folder / "points.csv"),
        outlines(folder / "outlines.csv"),
        lost_pairs(folder / "lost_pairs.csv"),
        incomplete(folder / "INCOMPLETE"),
        overlay(folder / "overlay"),
        report(folder / "report.html") {}
  std::filesystem::path camera;
  std::filesystem::path objects;
  std::filesystem::path frames;
  std::filesystem::path timing;
  std::filesystem::path points;
  std::filesystem::path outlines;
  std::filesystem::path lost_pairs;
  std::filesystem::path incomplete;  // IncompleteMark
  std::filesystem::path overlay;
  std::filesystem::path report;
};

// A file of rows, handed to the kernel at each flush(). Errors name the file.
class ResultFile {
 public:
  // Replaces what is there; the header line is left out when empty.
  [[nodiscard]] static Result<ResultFile> create(const std::filesystem::path& path, const std::string& header);
  [[nodiscard]] std::FILE* get() const { return file_.get(); }
  [[nodiscard]] Result<Ok> flush() const;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::filesystem::path path_;
};

// Makes the folder ready: created when absent; refused when it is a file, cannot be written, or holds anything
// already, unless `overwrite`, which removes the files of an earlier run and nothing else.
[[nodiscard]] Result<Ok> prepare_output_folder(const std::filesystem::path& folder, bool overwrite);

class ResultWriter {
 public:
  // The folder must exist (prepare_output_folder); files are created with their header lines.
  [[nodiscard]] static Result<ResultWriter> create(const std::filesystem::path& folder);
  [[nodiscard]] Result<Ok> append(const FrameResult& result, const FrameTiming& timing);

 private:
  ResultWriter() = default;
  void write_frame(const FrameResult& result);
  void write_timing(const FrameResult& result, const FrameTiming& timing);

  ResultFile camera_;
  ResultFile objects_;
  ResultFile frames_;
  ResultFile timing_;
};

// Covariance of the step motion with the left perturbation taken at the body's centroid instead of the world's
// origin (axes stay those of `world`): a lever arm of kilometres would otherwise turn rotation noise into metres.
[[nodiscard]] Matrix6d motion_covariance_at_centroid(const ObjectState& object);

}  // namespace pelorus
