#include "firmware-host/pelorus/top/status_page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "firmware-host/pelorus/top/page_writer.h"

namespace pelorus {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

PageStyle style_of(std::int8_t state) {
  switch (state) {
    case vis_odom_t::STATE_TRACKING:
      return PageStyle::good;
    case vis_odom_t::STATE_INIT:
    case vis_odom_t::STATE_DEGRADED:
    case vis_odom_t::STATE_STANDBY:
      return PageStyle::warning;
    default:
      return PageStyle::bad;
  }
}

std::string state_figures(const vis_odom_t& m) {
  return "quality " + (m.quality_percent < 0 ? std::string("-") : std::to_string(m.quality_percent)) + " %   resets " +
         std::to_string(m.reset_counter) + "   points " + std::to_string(m.points_static) + " static, " +
         std::to_string(m.points_moving) + " moving";
}

void put_state(const BusView& view, PageWriter& page) {
  if (!view.odom) {
    page.line("STATE", "");
    return;
  }
  const vis_odom_t& m = view.odom->message;
  PageLine made{{PageStyle::strong, padded_left("STATE", kLabelWidth)}};
  if (page.stale()) made.push_back({PageStyle::bad, page.age() + ", last "});
  made.push_back({page.stale() ? PageStyle::faint : style_of(m.state),
                  m.state_text + (m.reason_text.empty() ? "" : ": " + m.reason_text)});
  page.add_with_rest(std::move(made), state_figures(m));
}

void put_motion(const BusView& view, PageWriter& page) {
  if (!view.odom) return;
  const vis_odom_t& m = view.odom->message;
  if (!m.pose_valid) {
    page.line("POSE", "invalid: no estimate", PageStyle::bad);
    page.line("MOTION", "invalid: no estimate", PageStyle::bad);
    return;
  }
  const Attitude a = attitude_of(m);
  page.line("POSE", "x " + number_text(m.pos_m[0], 2, "") + " y " + number_text(m.pos_m[1], 2, "") + " z " +
                        number_text(m.pos_m[2], 2, " m") + " roll " + number_text(a.roll_rad, 1, "", kDegrees) +
                        " pitch " + number_text(a.pitch_rad, 1, "", kDegrees) + " yaw " +
                        number_text(a.yaw_rad, 1, " deg", kDegrees));
  if (!m.velocity_valid) {
    page.line("MOTION", "no velocity", PageStyle::warning);
    return;
  }
  const double(&v)[3] = m.vel_body_mps;
  const double(&w)[3] = m.rate_body_radps;
  page.line("MOTION", "ahead " + number_text(v[0], 2, "") + " starboard " + number_text(v[1], 2, "") + " down " +
                          number_text(v[2], 2, " m/s") + " turn " + number_text(w[0], 1, " ", kDegrees) +
                          number_text(w[1], 1, " ", kDegrees) + number_text(w[2], 1, " deg/s", kDegrees));
}

// "ring 12 (+3)": the total, and what came since the message before.
struct Grown {
  std::string facts;
  bool growing = false;
  void add(const char* name, std::int64_t now, std::int64_t before) {
    facts += (facts.empty() ? "" : "  ") + std::string(name) + " " + std::to_string(now);
    if (now <= before) return;
    facts += " (+" + std::to_string(now - before) + ")";
    growing = true;
  }
  [[nodiscard]] PageStyle style() const { return growing ? PageStyle::warning : PageStyle::plain; }
};

void put_counters(const vis_health_t& m, const vis_health_t& before, PageWriter& page) {
  Grown drops, faults;
  drops.add("source", m.dropped_in_source, before.dropped_in_source);
  drops.add("ring", m.dropped_ring_full, before.dropped_ring_full);
  drops.add("overtaken", m.dropped_superseded, before.dropped_superseded);
  drops.add("unpaired", m.dropped_unpaired, before.dropped_unpaired);
  drops.add("results", m.results_dropped, before.results_dropped);
  page.line("DROPS", drops.facts, drops.style());
  faults.add("losses", m.losses_of_track, before.losses_of_track);
  faults.add("silent", m.camera_timeouts, before.camera_timeouts);
  faults.add("frozen", m.frozen_spells, before.frozen_spells);
  faults.add("jumps", m.time_jumps, before.time_jumps);
  faults.add("LCM", m.lcm_errors, before.lcm_errors);
  faults.add("late", m.deadline_misses, before.deadline_misses);
  faults.add("shed", m.steps_shed, before.steps_shed);
  page.line("FAULTS", faults.facts, faults.style());
}

bool contains(const std::string& facts, const char* word) { return facts.find(word) != std::string::npos; }

// "can0 active, 12 sets, ...": the service's words (can_publisher.h); "off" without CAN.
PageStyle style_of_can(const std::string& facts) {
  const std::size_t blank = facts.find(' ');
  if (blank == std::string::npos) return PageStyle::plain;
  const std::string state = facts.substr(blank + 1, facts.find_first_of(",:", blank) - blank - 1);
  if (state == "active") return PageStyle::good;
  return state == "warning" ? PageStyle::warning : PageStyle::bad;
}

void put_health(const BusView& view, PageWriter& page) {
  if (!view.health) {
    page.line("HEALTH", "");
    return;
  }
  const vis_health_t& m = view.health->message;
  page.line("LATENCY", "p50 " + number_text(m.latency_p50_ms, 1, "") + " p99 " + number_text(m.latency_p99_ms, 1, "") +
                           " max " + number_text(m.latency_max_ms, 1, "") + " jitter " +
                           number_text(m.release_jitter_ms, 2, " ms") + "  step " + number_text(m.step_p50_ms, 1, "") +
                           " max " + number_text(m.step_max_ms, 1, " ms"));
  page.line("RATES", "pairs " + number_text(m.pairs_rate_hz, 1, "") + " results " +
                         number_text(m.results_rate_hz, 1, "") + " heard " + number_text(view.odom_rate_hz, 1, " Hz") +
                         "  gap max " + number_text(m.interval_max_ms, 0, "") + " jitter " +
                         number_text(m.interval_jitter_ms, 1, " ms"));
  put_counters(m, view.health_before ? view.health_before->message : m, page);
  page.line("PICTURE", "sync " + number_text(m.sync_error_ms, 2, " ms") + "  exposure " +
                           number_text(m.exposure_ms, 1, " ms") + "  gray " + number_text(m.mean_grey, 0, "") +
                           "  contrast " + number_text(m.contrast_grey, 0, "") + "  sigma " +
                           number_text(m.sigma_px, 2, " px"));
  page.line("HOST", "CPU " + number_text(m.cpu_percent, 0, " %") + "  memory " + number_text(m.memory_mb, 0, " MB") +
                        "  " + number_text(m.temperature_degc, 0, " C") + "   pelorusd " + m.version + ", up " +
                        number_text(m.uptime_s, 0, " s"));
  const bool refused = contains(m.privileges_text, "no real") || contains(m.privileges_text, "not locked") ||
                       contains(m.privileges_text, "refused");
  page.line("GRANTED", m.privileges_text, refused ? PageStyle::warning : PageStyle::plain);
  page.line("CAN", m.can_text, style_of_can(m.can_text));
  const bool disk_bad = contains(m.recorder_text, "full") || contains(m.recorder_text, "failed");
  page.line("DISK", number_text(m.disk_free_gb, 1, " GB free") + "   recorder " + m.recorder_text,
            disk_bad ? PageStyle::bad : PageStyle::plain);
}

PageLine body_line(const vis_track_t& track, const BusView& view, const vis_tracks_t& tracks, bool stale) {
  const double closing =
      view.odom ? closing_speed_mps(track, tracks, view.odom->message) : std::numeric_limits<double>::quiet_NaN();
  const Direction to = direction_of(track);
  const double(&v)[3] = track.vel_world_mps;
  const double speed = track.velocity_valid ? std::hypot(v[0], v[1], v[2]) : std::numeric_limits<double>::quiet_NaN();
  const std::string row =
      padded_right(std::to_string(track.id), 4) + "  " + padded_left(track.phase_text, 10) +
      padded_right(number_text(track.range_m, 2, ""), 8) + padded_right(number_text(closing, 2, ""), 12) +
      padded_right(number_text(speed, 2, ""), 11) + padded_right(number_text(to.bearing_rad, 0, "", kDegrees), 10) +
      padded_right(number_text(to.elevation_rad, 0, "", kDegrees), 9) + padded_right(std::to_string(track.points), 8);
  const bool sure = track.phase == vis_track_t::PHASE_CONFIRMED;
  return {{stale ? PageStyle::faint : (sure ? PageStyle::plain : PageStyle::warning), row}};
}

void put_bodies(const BusView& view, PageWriter& page, std::size_t room) {
  if (!view.tracks) {
    page.line("BODIES", "");
    return;
  }
  const vis_tracks_t& m = view.tracks->message;
  page.line("BODIES", std::to_string(m.n_tracks) + " moving, " + std::to_string(m.n_confirmed) + " confirmed");
  if (m.tracks.empty() || room < 2) return;
  page.add({{PageStyle::faint, "  id  phase        range m closing m/s  speed m/s  bearing  elev deg  points"}});
  std::vector<const vis_track_t*> nearest;
  for (const vis_track_t& track : m.tracks) nearest.push_back(&track);
  std::stable_sort(nearest.begin(), nearest.end(), [](const vis_track_t* a, const vis_track_t* b) {
    // Unknown ranges come last.
    return (std::isfinite(a->range_m) ? a->range_m : 1e300) < (std::isfinite(b->range_m) ? b->range_m : 1e300);
  });
  --room;
  const std::size_t shown = nearest.size() <= room ? nearest.size() : room - 1;
  for (std::size_t i = 0; i < shown; ++i) page.add(body_line(*nearest[i], view, m, page.stale()));
  if (shown < nearest.size()) {
    page.add({{PageStyle::warning, "  ... and " + std::to_string(nearest.size() - shown) + " farther away"}});
  }
}

void cut(PageLine& line, std::size_t columns) {
  for (PageSpan& span : line) {
    span.text.resize(std::min(span.text.size(), columns));
    columns -= span.text.size();
  }
}

}  // namespace

std::vector<PageLine> status_page(const BusView& view, ArrivalTime now, PageSize size) {
  constexpr std::size_t kFooter = 1;
  const auto columns = static_cast<std::size_t>(std::max(1, size.columns));
  PageWriter page(now, columns);
  page.add({{PageStyle::strong, "pelorus top"}, {PageStyle::plain, "  " + view.vehicle + "  " + view.url}});
  if (!view.trouble.empty()) page.add({{PageStyle::bad, view.trouble}});
  page.add({});
  page.part(view.odom, kStalePairs_s);
  put_state(view, page);
  put_motion(view, page);
  page.part(view.health, kStaleHealth_s);
  put_health(view, page);
  page.add({});
  std::vector<PageLine> lines = page.take();
  const auto rows = static_cast<std::size_t>(std::max(1, size.rows));
  PageWriter bodies(now, columns);
  bodies.part(view.tracks, kStalePairs_s);
  const std::size_t used = lines.size() + 1 + kFooter;
  put_bodies(view, bodies, rows > used ? rows - used : 0);
  for (PageLine& line : bodies.take()) lines.push_back(std::move(line));
  while (lines.size() + kFooter < rows) lines.emplace_back();
  if (lines.size() > rows - kFooter) lines.resize(rows - kFooter);
  lines.push_back({{PageStyle::faint, "q or Ctrl-C ends"}});
  for (PageLine& line : lines) cut(line, columns);
  return lines;
}

}  // namespace pelorus
