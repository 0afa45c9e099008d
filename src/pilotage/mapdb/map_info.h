#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/camera/camera.h"
#include "pilotage/mapdb/map_types.h"
#include "pilotage/vision/feature_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What a map says about itself.
struct MapInfo {
  int schema_version = 0;
  MapCrs crs;
  std::vector<MapInfoEntry> entries;  ///< In the order they were written.

  /// The value of a key, or nothing.
  std::optional<std::string> find(std::string_view key) const;
};

/// The camera that the map was prepared for (keys "camera.…", camera/camera_text.h); nothing when the map says nothing
/// of one. Throws DataError beginning with `file` when a key is missing, unknown or a duplicate, or a value is not one
/// of a camera.
std::optional<Camera> camera_of_info(const MapInfo& info, const std::string& file);

/// How the map's features are described (keys "features.…", the fields of FeatureOptions); the defaults when the map
/// says nothing of it. Throws DataError beginning with `file` when a key is missing, unknown or a duplicate, a value is
/// outside its range, or the pattern's tests are not those of this library (pattern_digest).
FeatureOptions features_of_info(const MapInfo& info, const std::string& file);

/// Standard deviation of the ground heights that the map stores (key "elevation_sigma_m"); nothing when the map does
/// not say. Throws DataError beginning with `file` when the value is no number in [0, 100].
std::optional<double> elevation_sigma_m_of_info(const MapInfo& info, const std::string& file);

/// What the line "pattern_digest" of map_info says of a pattern that was learned: BLAKE2b-256 of its tests, four signed
/// bytes each, in hexadecimal digits. "" for the others, whose name says all.
std::string pattern_digest(DescriptorPattern pattern);

}  // namespace pilotage

#pragma GCC visibility pop
