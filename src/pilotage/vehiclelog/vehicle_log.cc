#include "pilotage/vehiclelog/vehicle_log.h"

#include <algorithm>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"
#include "pilotage/vehiclelog/log_readers.h"

namespace pilotage {
namespace {

VehicleLog parse_log_of_format(LogFormat format, const std::string& name, std::string_view bytes,
                               const std::optional<LogOrigin>& origin) {
  switch (format) {
    case LogFormat::kUlog:
      return parse_ulog(name, bytes);
    case LogFormat::kDataFlash:
      return parse_dataflash_log(name, bytes);
    case LogFormat::kTelemetry:
      return parse_telemetry_log(name, bytes);
    case LogFormat::kAirSim:
      break;
  }
  if (!origin) {
    throw UsageError(name +
                     ": an AirSim recording says positions from its own origin: say where on Earth that is "
                     "(OriginGeopoint of settings.json)");
  }
  return parse_airsim_recording(name, bytes, *origin);
}

bool is_empty(const LoggedTrack& track) {
  return track.positions.empty() && track.velocities.empty() && track.attitudes.empty();
}

void add_count(std::vector<std::string>& notes, std::int64_t count, const std::string& one, const std::string& many) {
  if (count > 0) notes.push_back(std::to_string(count) + " " + (count == 1 ? one : many));
}

void add_losses(std::vector<std::string>& notes, const LogLosses& losses) {
  add_count(notes, losses.bytes_skipped, "byte holds no record that can be read",
            "bytes hold no record that can be read");
  add_count(notes, losses.bad_checksums, "record has a wrong checksum", "records have a wrong checksum");
  add_count(notes, losses.bad_values, "record has a number that cannot be", "records have a number that cannot be");
  for (const auto& [source, count] : losses.other_sources) {
    add_count(notes, count, "record of " + source + " is left out: another one is taken",
              "records of " + source + " are left out: another one is taken");
  }
  add_count(notes, losses.ranges_left_out, "reading of a range finder says no height, and is left out",
            "readings of range finders say no height (no signal, out of range, tilted by more than 45°), and are left "
            "out");
  add_count(notes, losses.bad_times, "record has a time that contradicts its neighbours",
            "records have a time that contradicts their neighbours");
  if (losses.clock_jumps > 0) {
    notes.push_back("the clock was set back " + std::to_string(losses.clock_jumps) +
                    (losses.clock_jumps == 1 ? " time" : " times") + ": of the parts the largest is used, " +
                    std::to_string(losses.records_left_out) + " records of the others are left out");
  }
  add_count(notes, losses.gaps, "gap of more than 60 s", "gaps of more than 60 s");
  if (losses.dropouts > 0) {
    notes.push_back("the logger lost records " + std::to_string(losses.dropouts) +
                    (losses.dropouts == 1 ? " time, " : " times, ") + format_fixed(losses.dropout_s, 1) + " s in all");
  }
  if (losses.truncated) notes.emplace_back("the file ends inside a record");
}

}  // namespace

std::optional<LogFormat> log_format_of(std::string_view bytes) {
  if (is_ulog(bytes)) return LogFormat::kUlog;
  if (is_dataflash_log(bytes)) return LogFormat::kDataFlash;
  if (is_airsim_recording(bytes)) return LogFormat::kAirSim;
  if (is_telemetry_log(bytes)) return LogFormat::kTelemetry;
  return std::nullopt;
}

VehicleLog parse_vehicle_log(const std::string& name, std::string_view bytes, const std::optional<LogOrigin>& origin) {
  const std::optional<LogFormat> format = log_format_of(bytes);
  if (!format) {
    throw DataError(name +
                    ": is no log that is known: its first bytes are not those of PX4's ULog, ArduPilot's DataFlash, "
                    "a telemetry log of MAVLink, or AirSim's airsim_rec.txt");
  }
  VehicleLog log = parse_log_of_format(*format, name, bytes, origin);
  if (is_empty(log.estimate) && is_empty(log.gnss) && is_empty(log.truth) && log.captures.empty()) {
    std::string text = name + ": holds no position, attitude or capture that can be read";
    for (const std::string& note : notes_of_log(log)) {
      if (!note.starts_with("the log has no")) text += "; " + note;
    }
    throw DataError(text);
  }
  return log;
}

VehicleLog read_vehicle_log(const std::filesystem::path& path, const std::optional<LogOrigin>& origin) {
  return parse_vehicle_log(path.string(), read_file(path), origin);
}

std::vector<std::string> notes_of_log(const VehicleLog& log) {
  std::vector<std::string> notes;
  add_losses(notes, log.losses);
  const bool no_truth = log.truth.positions.empty();
  if (log.estimate.positions.empty() && no_truth) notes.emplace_back("the log has no position of the autopilot's own");
  if (log.gnss.positions.empty() && no_truth) notes.emplace_back("the log has no position by GNSS");
  if (log.estimate.attitudes.empty() && log.truth.attitudes.empty()) notes.emplace_back("the log has no attitude");
  if (log.captures.empty()) notes.emplace_back("the log has no capture or trigger of a camera");
  return notes;
}

double duration_s(const VehicleLog& log) {
  double first_s = 0;
  double last_s = 0;
  bool any = false;
  const auto include = [&](const auto& records) {
    if (records.empty()) return;
    first_s = any ? std::min(first_s, records.front().time_s) : records.front().time_s;
    last_s = any ? std::max(last_s, records.back().time_s) : records.back().time_s;
    any = true;
  };
  for (const LoggedTrack* track : {&log.estimate, &log.gnss, &log.truth}) {
    include(track->positions);
    include(track->velocities);
    include(track->attitudes);
  }
  include(log.captures);
  return last_s - first_s;
}

}  // namespace pilotage
