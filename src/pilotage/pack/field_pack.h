#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mission/input_files.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A file of a field pack.
struct PackFile {
  std::string name;  ///< In the folder of the pack; no path.
  std::int64_t bytes = 0;
  std::string digest;  ///< "blake2b-256:…"
};

/// A field pack is one folder that goes to the field: map, imagery for ground stations, the route as it was planned,
/// the page, and this, which names each of them with its digest (schemas/pack-manifest.schema.json). Its signature,
/// pack_manifest.json.minisig, is one of all.
struct PackManifest {
  std::string software_version;
  std::string title;
  std::string verdict;      ///< The report's first sentence.
  std::string assumptions;  ///< What it takes for granted.
  std::string evidence;     ///< What it rests on.
  MapPurpose purpose;
  std::string map_digest;         ///< Of the map's content, 64 hex digits.
  std::vector<PackFile> files;    ///< All but the manifest and its signature, by name.
  std::vector<InputFile> inputs;  ///< What it was made of: digests, dates, licences.
};

inline constexpr const char* kPackManifestName = "pack_manifest.json";
inline constexpr const char* kPackMapName = "map.gpkg";  ///< Each pack has it.

/// The entry of a file. Throws DataError when it cannot be read.
PackFile pack_file(const std::filesystem::path& folder, const std::string& name);

/// The text of the manifest. The same manifest gives the same bytes.
std::string pack_manifest_text(const PackManifest& manifest);

/// Reads it back. Throws DataError beginning with `name` when it is not what the schema says, a file's name leads
/// out of the folder, or there is no map.
PackManifest pack_manifest_from_text(const std::string& text, const std::string& name);

/// Something wrong with a pack.
struct PackProblem {
  std::string file;     ///< Its name in the folder.
  std::string message;  ///< A sentence that begins with it.
};

/// A folder held against its manifest.
struct PackCheck {
  std::vector<PackProblem> problems;   ///< Files that the manifest names and that are missing or not the same.
  std::vector<std::string> strangers;  ///< Names in the folder that the manifest does not name, in order.
};

/// Checks every file that the manifest names. Whether it was signed, and what is in the map, is not asked here. Throws
/// DataError when the folder cannot be read, Interrupted.
PackCheck check_pack(const std::filesystem::path& folder, const PackManifest& manifest, const Progress& progress = {});

/// What a map is for, as JSON says it: "mission_name", "map_version", "created", "valid_until", those that are said.
nlohmann::ordered_json purpose_to_json(const MapPurpose& purpose);

}  // namespace pilotage

#pragma GCC visibility pop
