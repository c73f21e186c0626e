#include "firmware-host/pelorus/doctor/sources.h"

#include <filesystem>

#include "drivers/replay/lcm_event_file.h"
#include "firmware-host/runtime/calibration.h"
#include "firmware-host/runtime/replay_source.h"

namespace pelorus {
namespace {

PairFlow flow_of(const StereoCalibration& calibration, double rate_hz) {
  const auto bytes = [](const CameraIntrinsics& view) {
    return static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);
  };
  return {bytes(calibration.left) + bytes(calibration.right), rate_hz};
}

HostCheck not_the_source(const std::string& kind, const ServiceConfig& config) {
  return {Verdict::ok, "source " + kind, "not the source (source.kind: " + config.source.kind + ")", ""};
}

HostCheck failed(const std::string& topic, const Error& error) {
  HostCheck check{Verdict::fail, topic, error.place + ": " + error.detail, error.cure};
  if (check.cure.empty()) check.cure = "see the message";
  return check;
}

// Recording or scene: opened as the service would.
HostCheck check_played(const std::string& kind, const ServiceConfig& config, bool configured,
                       std::optional<PairFlow>& flow) {
  if (config.source.kind != kind) return not_the_source(kind, config);
  HostCheck check{Verdict::ok, "source " + kind, "", ""};
  const std::string& path = config.source.path;
  if (path.empty()) {
    check.found = "source.path is not given";
    if (configured) check.verdict = Verdict::fail;
    if (configured) check.cure = "write where the pairs come from, or source.kind: aravis or v4l2";
    return check;
  }
  std::error_code ignored;
  const bool recording = std::filesystem::is_directory(path, ignored) || LcmEventFile::is_log(path);
  if (recording != (kind == "replay")) {
    return {Verdict::fail, check.topic,
            path + (recording ? " is a recording" : " is no folder of recorded pairs and no LCM log"),
            recording ? "source.kind: replay" : "check source.path; a scene needs source.kind: synthetic"};
  }
  const auto source = open_source(path, config.source.calibration);
  if (!source) return failed(check.topic, source.error());
  if (config.source.rate_hz > 0) flow = flow_of(source.value()->calibration(), config.source.rate_hz);
  const std::size_t pairs = source.value()->pair_count();
  check.found = path + " opens" + (pairs > 0 ? ", " + std::to_string(pairs) + " pairs" : "");
  return check;
}

HostCheck check_calibration_file(const ServiceConfig& config, std::optional<PairFlow>& flow) {
  HostCheck check{Verdict::ok, "calibration", "", ""};
  if (config.source.calibration.empty()) {
    return {Verdict::fail, check.topic, "source.calibration is not given, and live cameras bring none",
            "name the calibration file of this pair of cameras"};
  }
  const auto loaded = load_calibration(config.source.calibration);
  if (!loaded) return failed(check.topic, loaded.error());
  flow = flow_of(loaded.value().calibration, config.camera.rate_hz);
  const CameraIntrinsics& left = loaded.value().calibration.left;
  check.found = loaded.value().origin + ", " + std::to_string(left.width) + "x" + std::to_string(left.height);
  return check;
}

}  // namespace

SourceFindings check_sources(const ServiceConfig& config, bool configured) {
  SourceFindings findings;
  for (const char* kind : {"replay", "synthetic"}) {
    findings.checks.push_back(check_played(kind, config, configured, findings.flow));
  }
  findings.checks.push_back(check_v4l2(config));
  findings.checks.push_back(check_aravis(config));
  const bool live = config.source.kind == "aravis" || config.source.kind == "v4l2";
  if (config.source.kind == "aravis") {
    std::vector<CameraPath> paths;
    for (const std::string& name : {config.camera.left, config.camera.right}) paths.push_back({name, path_mtu(name)});
    findings.checks.push_back(judge_packets(config.camera, paths));
  }
  if (live) findings.checks.push_back(check_calibration_file(config, findings.flow));
  return findings;
}

}  // namespace pelorus
