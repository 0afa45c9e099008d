#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/utc_time.h"
#include "pilotage/camera/camera.h"
#include "pilotage/mapdb/map_info.h"

#pragma GCC visibility push(default)

namespace pilotage {

class MapReader;

/// What a map is for, as its planner said it and a signature of the map covers it (keys "purpose.…" of map_info). The
/// area is that of its tiles and the camera that of MapReader::camera(); what is not said here is not known.
struct MapPurpose {
  std::optional<std::string> mission_name;  ///< 1 to 100 bytes without control characters.
  std::optional<std::int64_t> map_version;  ///< From 1; each map that replaces another has a larger one.
  std::optional<UtcTime> created;
  std::optional<UtcTime> valid_until;  ///< The map is not to be flown from then on; later than `created`.

  bool operator==(const MapPurpose&) const = default;
};

inline constexpr std::int64_t kMaxMapVersion = 2147483647;

/// What is wrong with a purpose, as a sentence that begins with the field; "" when nothing is.
std::string purpose_problem(const MapPurpose& purpose);

/// The lines of map_info that say it, and back. purpose_of_info throws DataError beginning with `file` when a key is
/// unknown or stands twice, or a value is not one of a purpose.
std::vector<MapInfoEntry> purpose_entries(const MapPurpose& purpose);
MapPurpose purpose_of_info(const MapInfo& info, const std::string& file);

/// One line for people: "mission "harbour", map version 7, made …, valid until …"; "" when nothing is said.
std::string purpose_text(const MapPurpose& purpose);

/// What a flight asks of its map. What is not given is not checked.
struct MapRequirements {
  std::optional<std::string> mission_name;  ///< The map must be of this mission.
  /// The map must be of this version or a later one: an aircraft keeps the highest version that it has flown, so that
  /// nobody gives it an old map again that is rightly signed.
  std::optional<std::int64_t> min_version;
  /// The map must be prepared for this camera, to within kSameCameraWithin_deg (camera/camera_difference.h); a map that
  /// does not say for which is taken.
  std::optional<Camera> camera;
  /// The time by a clock that may be trusted: the map must not have expired. Nothing on an aircraft without such a
  /// clock: expiry is then not checked there, but before the flight, on the ground; min_version still holds.
  std::optional<UtcTime> now;
};

/// Cameras that differ by less are the same one: 5 % of the focal length of a lens with a view of 75°.
inline constexpr double kSameCameraWithin_deg = 2;

/// Throws IntegrityError, with what to do about it, when the map does not meet a requirement, or does not say what one
/// asks for; when `now` is more than a day before the map was made, which is a clock that cannot tell what has expired.
void check_purpose(const MapReader& map, const MapRequirements& required);

}  // namespace pilotage

#pragma GCC visibility pop
