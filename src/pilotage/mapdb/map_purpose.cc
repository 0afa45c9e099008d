#include "pilotage/mapdb/map_purpose.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_difference.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {
namespace {

constexpr std::string_view kPurpose = "purpose.";
constexpr std::size_t kMaxMissionNameBytes = 100;
constexpr std::chrono::hours kClockSlack{24};

std::int64_t map_version_from_text(const std::string& where, const std::string& text) {
  std::int64_t version = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), version);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw DataError(where + " = \"" + text + "\" is not a number");
  }
  return version;
}

UtcTime time_from_text(const std::string& where, const std::string& text) {
  const std::optional<UtcTime> time = parse_utc_time(text);
  if (!time) throw DataError(where + " = \"" + text + "\" is not a time like 2026-03-01T06:30:00Z");
  return *time;
}

void check_time(const std::string& map, const MapPurpose& purpose, UtcTime now) {
  if (purpose.valid_until && now >= *purpose.valid_until) {
    throw IntegrityError(map + ": expired at " + format_utc_time(*purpose.valid_until) + ", and it is " +
                         format_utc_time(now) + ": prepare it anew with a later valid_until, or allow expired maps");
  }
  if (purpose.valid_until && purpose.created && now < *purpose.created - kClockSlack) {
    throw IntegrityError(map + ": was made at " + format_utc_time(*purpose.created) + ", but the clock says " +
                         format_utc_time(now) + ": set the clock, which cannot tell whether the map has expired");
  }
}

void check_same_camera(const std::string& map, const Camera& of_map, const Camera& given) {
  const double difference_deg = camera_difference_deg(of_map, given);
  if (difference_deg <= kSameCameraWithin_deg) return;
  const std::string difference =
      std::isfinite(difference_deg)
          ? "looks up to " + format_fixed(difference_deg, 1) +
                "° elsewhere than the one that is given (allowed: " + format_fixed(kSameCameraWithin_deg, 0) + "°)"
          : "has another shape than the one that is given";
  throw IntegrityError(map + ": is for another camera, which " + difference +
                       ": take the map of this camera, give the camera of the map, or allow another camera");
}

}  // namespace

std::string purpose_problem(const MapPurpose& purpose) {
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  const std::string name = purpose.mission_name.value_or("-");
  if (name.empty() || name.size() > kMaxMissionNameBytes || std::any_of(name.begin(), name.end(), is_control)) {
    return "mission_name is not 1 to " + std::to_string(kMaxMissionNameBytes) + " bytes without control characters";
  }
  const std::int64_t version = purpose.map_version.value_or(1);
  if (version < 1 || version > kMaxMapVersion) {
    return "map_version = " + std::to_string(version) + " is outside [1, " + std::to_string(kMaxMapVersion) + "]";
  }
  if (purpose.created && purpose.valid_until && *purpose.valid_until <= *purpose.created) {
    return "valid_until = " + format_utc_time(*purpose.valid_until) +
           " is not after created = " + format_utc_time(*purpose.created);
  }
  return {};
}

std::vector<MapInfoEntry> purpose_entries(const MapPurpose& purpose) {
  std::vector<MapInfoEntry> entries;
  const auto add = [&](const char* key, std::string value) {
    entries.push_back({std::string(kPurpose) + key, std::move(value)});
  };
  if (purpose.mission_name) add("mission_name", *purpose.mission_name);
  if (purpose.map_version) add("map_version", std::to_string(*purpose.map_version));
  if (purpose.created) add("created", format_utc_time(*purpose.created));
  if (purpose.valid_until) add("valid_until", format_utc_time(*purpose.valid_until));
  return entries;
}

MapPurpose purpose_of_info(const MapInfo& info, const std::string& file) {
  MapPurpose purpose;
  std::set<std::string> seen;
  for (const MapInfoEntry& entry : info.entries) {
    if (!entry.key.starts_with(kPurpose)) continue;
    const std::string where = file + ": map_info: " + entry.key;
    const std::string key = entry.key.substr(kPurpose.size());
    if (!seen.insert(key).second) throw DataError(where + " stands twice");
    if (key == "mission_name") {
      purpose.mission_name = entry.value;
    } else if (key == "map_version") {
      purpose.map_version = map_version_from_text(where, entry.value);
    } else if (key == "created") {
      purpose.created = time_from_text(where, entry.value);
    } else if (key == "valid_until") {
      purpose.valid_until = time_from_text(where, entry.value);
    } else {
      throw DataError(where + " is not known: a newer program may read it");
    }
  }
  const std::string problem = purpose_problem(purpose);
  if (!problem.empty()) throw DataError(file + ": map_info: " + std::string(kPurpose) + problem);
  return purpose;
}

std::string purpose_text(const MapPurpose& purpose) {
  std::vector<std::string> parts;
  if (purpose.mission_name) parts.push_back("mission \"" + *purpose.mission_name + "\"");
  if (purpose.map_version) parts.push_back("map version " + std::to_string(*purpose.map_version));
  if (purpose.created) parts.push_back("made " + format_utc_time(*purpose.created));
  if (purpose.valid_until) parts.push_back("valid until " + format_utc_time(*purpose.valid_until));
  return join(parts, ", ");
}

void check_purpose(const MapReader& map, const MapRequirements& required) {
  const MapPurpose& purpose = map.purpose();
  if (required.mission_name && purpose.mission_name != required.mission_name) {
    throw IntegrityError(map.name() + ": " +
                         (purpose.mission_name ? "is for the mission \"" + *purpose.mission_name + "\""
                                               : std::string("does not say for which mission it is")) +
                         ", and \"" + *required.mission_name + "\" is asked for: take the map of that mission");
  }
  if (required.min_version && purpose.map_version.value_or(0) < *required.min_version) {
    throw IntegrityError(map.name() + ": " +
                         (purpose.map_version ? "is map version " + std::to_string(*purpose.map_version)
                                              : std::string("has no map version")) +
                         ", and at least " + std::to_string(*required.min_version) +
                         " is asked for: take the latest map of the mission");
  }
  if (required.now) check_time(map.name(), purpose, *required.now);
  if (required.camera && map.camera()) check_same_camera(map.name(), *map.camera(), *required.camera);
}

}  // namespace pilotage
