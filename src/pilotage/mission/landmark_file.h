#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/mapdb/map_landmarks.h"

namespace pilotage {

class JsonObject;

/// A detector as JSON, and what its keys in an object say. Throws DataError naming file and path.
nlohmann::ordered_json detector_to_json(const LandmarkDetector& detector);
LandmarkDetector detector_from_json(JsonObject& json);

/// A file of ours that may not be changed: `json` begins with these keys, and ends with the digest of what stands
/// before.
nlohmann::ordered_json digested_json(const std::string& format, int version, const nlohmann::ordered_json& content);

/// Reads such a file whole, but for its own keys. Throws DataError when it cannot be read or is of another format
/// (`written_by` says which command writes it) or version; IntegrityError when its content is not that of its digest.
nlohmann::ordered_json read_digested_json(const std::filesystem::path& path, const std::string& format, int version,
                                          const std::string& written_by);

/// Landmarks for a map as JSON (schemas/map-landmarks.schema.json), with the digest of its content.
nlohmann::ordered_json map_landmarks_to_json(const MapLandmarks& landmarks);

/// Throws as read_digested_json, and DataError for detectors and landmarks that no map may hold.
MapLandmarks read_map_landmarks(const std::filesystem::path& path);

}  // namespace pilotage
