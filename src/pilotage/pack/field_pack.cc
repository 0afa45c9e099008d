#include "pilotage/pack/field_pack.h"

#include <algorithm>
#include <set>
#include <system_error>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mission/licence_json.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using PackJson = nlohmann::ordered_json;

constexpr int kPackVersion = 1;
constexpr const char* kAlgorithm = "blake2b-256:";

UtcTime time_of(JsonObject& object, const std::string& key) {
  const auto time = parse_utc_time(object.text(key));
  if (!time) object.fail(key, "a time like 2026-03-01T06:30:00Z");
  return *time;
}

MapPurpose purpose_from_json(JsonObject object) {
  MapPurpose purpose;
  if (object.has("mission_name")) purpose.mission_name = object.text("mission_name");
  if (object.has("map_version")) purpose.map_version = object.integer("map_version", 1, kMaxMapVersion);
  if (object.has("created")) purpose.created = time_of(object, "created");
  if (object.has("valid_until")) purpose.valid_until = time_of(object, "valid_until");
  object.finish();
  return purpose;
}

bool is_plain_name(const std::string& name) {
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_of(std::string("/\\\0", 3)) == std::string::npos;
}

bool is_digest(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

PackFile file_from_json(JsonObject& object) {
  constexpr std::int64_t kMostBytes = std::int64_t{1} << 43;  // of as many as a manifest can name, the sum fits
  PackFile file{object.text("name"), object.integer("bytes", 0, kMostBytes), object.text("digest")};
  object.finish();
  if (!is_plain_name(file.name)) object.fail("name", "the name of a file in the folder, without a path");
  if (file.name == kPackManifestName || file.name == signature_path_of(kPackManifestName)) {
    object.fail("name", "another file than the manifest and its signature");
  }
  if (!file.digest.starts_with(kAlgorithm) || !is_digest(file.digest.substr(std::string_view(kAlgorithm).size()))) {
    object.fail("digest", "\"blake2b-256:\" and 64 hexadecimal digits");
  }
  return file;
}

InputFile input_from_json(JsonObject& object) {
  InputFile file{object.text("role"), object.text("name"), object.text("date"), object.text("digest"),
                 licence_from_json(object)};
  object.finish();
  return file;
}

/// "" when the file is what the manifest says.
std::string problem_of(const fs::path& path, const PackFile& file) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return "is missing";
  if (!fs::is_regular_file(status)) return "is no regular file";
  const auto bytes = static_cast<std::int64_t>(fs::file_size(path, error));
  if (!error && bytes != file.bytes) {
    return "has " + std::to_string(bytes) + " bytes, the manifest says " + std::to_string(file.bytes);
  }
  try {
    if (kAlgorithm + file_digest(path) != file.digest) return "the digest does not match: it was changed or is damaged";
  } catch (const DataError&) {
    return "cannot be read";
  }
  return "";
}

}  // namespace

nlohmann::ordered_json purpose_to_json(const MapPurpose& purpose) {
  PackJson json = PackJson::object();
  if (purpose.mission_name) json["mission_name"] = *purpose.mission_name;
  if (purpose.map_version) json["map_version"] = *purpose.map_version;
  if (purpose.created) json["created"] = format_utc_time(*purpose.created);
  if (purpose.valid_until) json["valid_until"] = format_utc_time(*purpose.valid_until);
  return json;
}

PackFile pack_file(const fs::path& folder, const std::string& name) {
  const fs::path path = folder / name;
  PackFile file{name, 0, kAlgorithm + file_digest(path)};
  std::error_code error;
  file.bytes = static_cast<std::int64_t>(fs::file_size(path, error));
  if (error) throw DataError(path.string() + ": cannot be read: " + error.message());
  return file;
}

std::string pack_manifest_text(const PackManifest& manifest) {
  PackJson json{{"pilotage_pack", kPackVersion},
                {"software_version", manifest.software_version},
                {"title", manifest.title},
                {"verdict", manifest.verdict},
                {"assumptions", manifest.assumptions},
                {"evidence", manifest.evidence},
                {"purpose", purpose_to_json(manifest.purpose)},
                {"map_digest", manifest.map_digest},
                {"files", PackJson::array()},
                {"inputs", PackJson::array()}};
  std::vector<PackFile> files = manifest.files;
  std::sort(files.begin(), files.end(), [](const PackFile& a, const PackFile& b) { return a.name < b.name; });
  for (const PackFile& file : files) {
    json["files"].push_back({{"name", file.name}, {"bytes", file.bytes}, {"digest", file.digest}});
  }
  for (const InputFile& input : manifest.inputs) {
    PackJson& next = json["inputs"].emplace_back(
        PackJson{{"role", input.role}, {"name", input.name}, {"date", input.date}, {"digest", input.digest}});
    add_licence(input.licence, next);
  }
  return json_text(json);
}

PackManifest pack_manifest_from_text(const std::string& text, const std::string& name) {
  const PackJson json = parse_json(name, text);
  JsonObject object(json, name);
  if (!object.has("pilotage_pack")) throw DataError(name + ": is not the manifest of a field pack");
  const std::int64_t version = object.integer("pilotage_pack", 1);
  if (version > kPackVersion) {
    throw DataError(name + ": pack version " + std::to_string(version) + " is newer than this program reads (" +
                    std::to_string(kPackVersion) + ")");
  }
  PackManifest manifest;
  manifest.software_version = object.text("software_version");
  manifest.title = object.text("title");
  manifest.verdict = object.text("verdict");
  manifest.assumptions = object.text("assumptions");
  manifest.evidence = object.text("evidence");
  manifest.purpose = purpose_from_json(object.object("purpose"));
  manifest.map_digest = object.text("map_digest");
  if (!is_digest(manifest.map_digest)) object.fail("map_digest", "64 hexadecimal digits");
  std::set<std::string> names;
  for (JsonObject& file : object.objects("files")) {
    manifest.files.push_back(file_from_json(file));
    if (!names.insert(manifest.files.back().name).second) file.fail("name", "each file once");
  }
  if (!names.contains(kPackMapName)) throw DataError(name + ": names no " + kPackMapName + ", and each pack has one");
  for (JsonObject& input : object.objects("inputs")) manifest.inputs.push_back(input_from_json(input));
  object.finish();
  return manifest;
}

PackCheck check_pack(const fs::path& folder, const PackManifest& manifest, const Progress& progress) {
  PackCheck check;
  std::set<std::string> expected{kPackManifestName, signature_path_of(kPackManifestName).string()};
  std::int64_t total = 0;
  for (const PackFile& file : manifest.files) total += file.bytes;
  std::int64_t done = 0;
  for (const PackFile& file : manifest.files) {
    report_progress(progress, "checking the pack", done, total);
    expected.insert(file.name);
    const fs::path path = folder / file.name;
    if (const std::string problem = problem_of(path, file); !problem.empty()) {
      check.problems.push_back({file.name, path.string() + ": " + problem});
    }
    done += file.bytes;
  }
  report_progress(progress, "checking the pack", total, total);
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!expected.contains(name)) check.strangers.push_back(name);
  }
  if (error) throw DataError(folder.string() + ": cannot be read: " + error.message());
  std::sort(check.strangers.begin(), check.strangers.end());
  return check;
}

}  // namespace pilotage
