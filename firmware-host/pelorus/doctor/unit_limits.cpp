#include "firmware-host/pelorus/doctor/unit_limits.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>

namespace pelorus {
namespace {

constexpr std::array<const char*, 5> kFolders = {"/etc/systemd/system", "/run/systemd/system",
                                                 "/usr/local/lib/systemd/system", "/usr/lib/systemd/system",
                                                 "/lib/systemd/system"};
constexpr const char* kUnit = "pelorusd.service";
constexpr int kNeededPriority = 40;  // of capture, the highest the program asks for (process_setup.cpp)

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

void read_service_section(const std::string& text, std::map<std::string, std::string>& service) {
  std::istringstream lines(text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    line = trimmed(line);
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    if (line[0] == '[') {
      inside = line == "[Service]";
      continue;
    }
    const std::size_t equals = line.find('=');
    if (!inside || equals == std::string::npos) continue;
    const std::string key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
    // Lists grow, and an empty value empties them.
    std::string& known = service[key];
    known = key == "AmbientCapabilities" && !value.empty() ? known + " " + value : value;
  }
}

bool has_word(const std::string& words, const std::string& wanted) {
  std::istringstream stream(words);
  for (std::string word; stream >> word;)
    if (word == wanted) return true;
  return false;
}

}  // namespace

std::string UnitLimits::value(const std::string& key) const {
  const auto found = service.find(key);
  return found == service.end() ? "" : found->second;
}

bool UnitLimits::grants_realtime() const {
  const std::string limit = value("LimitRTPRIO");
  if (limit == "infinity") return true;
  return !limit.empty() && std::all_of(limit.begin(), limit.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
         limit.size() < 9 && std::stoi(limit) >= kNeededPriority;
}

bool UnitLimits::grants_locked_memory() const { return value("LimitMEMLOCK") == "infinity"; }

bool UnitLimits::grants_raw_network() const {
  return has_word(value("AmbientCapabilities"), "CAP_NET_RAW") || value("User").empty() || value("User") == "root";
}

std::optional<UnitLimits> read_unit(const HostFiles& files) {
  UnitLimits unit;
  for (const char* folder : kFolders) {
    const auto text = files.text(std::string(folder) + "/" + kUnit);
    if (!text) continue;
    unit.path = std::string(folder) + "/" + kUnit;
    read_service_section(*text, unit.service);
    break;
  }
  if (unit.path.empty()) return std::nullopt;
  // Of drop-ins with one name, the folder of the highest rank wins.
  std::map<std::string, std::string> drop_ins;
  for (const char* folder : kFolders) {
    for (const std::string& path : files.entries(std::string(folder) + "/" + kUnit + ".d")) {
      if (path.ends_with(".conf")) drop_ins.emplace(std::filesystem::path(path).filename().string(), path);
    }
  }
  for (const auto& [name, path] : drop_ins) read_service_section(files.text(path).value_or(""), unit.service);
  unit.drop_ins = static_cast<int>(drop_ins.size());
  return unit;
}

HostCheck check_unit(const std::optional<UnitLimits>& unit, const ServiceConfig& config) {
  HostCheck check{Verdict::ok, "systemd unit", "", ""};
  if (!unit) {
    check.found = "pelorusd.service is not installed: the limits of the shell that starts pelorusd hold";
    return check;
  }
  check.found = unit->path;
  if (unit->drop_ins > 0) check.found += " with " + std::to_string(unit->drop_ins) + " drop-in(s)";
  std::string missing, cure;
  const auto require = [&](bool granted, const std::string& key, const std::string& line) {
    if (granted) return;
    missing += (missing.empty() ? "" : ", ") + key + "=" + unit->value(key);
    cure += (cure.empty() ? "" : ", ") + line;
  };
  if (config.process.realtime) require(unit->grants_realtime(), "LimitRTPRIO", "LimitRTPRIO=50");
  if (config.process.lock_memory) require(unit->grants_locked_memory(), "LimitMEMLOCK", "LimitMEMLOCK=infinity");
  if (config.source.kind == "aravis" && config.camera.packet_socket) {
    require(unit->grants_raw_network(), "AmbientCapabilities", "AmbientCapabilities=CAP_NET_RAW");
  }
  const std::filesystem::path recordings(config.recorder.folder);
  const bool writable = recordings.is_absolute() || !unit->value("WorkingDirectory").empty();
  if (missing.empty() && writable) {
    check.found += ": real time, locked memory and capabilities as the configuration asks";
    return check;
  }
  check.verdict = Verdict::warn;
  if (!missing.empty()) check.found += " does not grant what the configuration asks for: " + missing;
  if (!writable) {
    check.found += ": recorder.folder '" + config.recorder.folder + "' is relative, which for the service is below /";
    cure += std::string(cure.empty() ? "" : "; ") + "recorder.folder: /var/lib/pelorus/recordings";
  }
  check.cure = (missing.empty() ? "" : "systemctl edit pelorusd, section [Service]: ") + cure;
  return check;
}

}  // namespace pelorus
