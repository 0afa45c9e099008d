#include <filesystem>
#include <optional>

#include "commands.h"
#include "signed_input.h"

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"
#include "pilotage/pack/field_pack.h"

namespace pilotage {
namespace {

void add_purpose(const MapPurpose& purpose, CommandResult& result) {
  const std::string text = purpose_text(purpose);
  if (text.empty()) return;
  result.text += text + "\n";
  result.json["purpose"] = purpose_to_json(purpose);
}

CommandResult verify_map_file(const std::string& path, const TrustOptions& options, const Progress& progress) {
  const MapRequirements required = requirements_of(options);
  const std::optional<SignedInput> input = read_signed_input(options, path);
  const VerifyReport report = input ? verify_map(input->map, progress) : verify_map(path, progress);
  CommandResult result;
  result.json = {{"map", path},
                 {"intact", report.ok()},
                 {"tiles", report.tiles},
                 {"descriptor_rows", report.descriptor_rows},
                 {"descriptors", report.descriptors},
                 {"chips", report.chips},
                 {"landmarks", report.landmarks},
                 {"bytes", report.bytes},
                 {"digest", report.content_digest},
                 {"problems", nlohmann::ordered_json::array()}};
  for (const MapProblem& problem : report.problems) {
    result.text += problem.message + "\n";
    result.json["problems"].push_back({{"table", problem.table}, {"message", problem.message}});
    if (problem.tile_id) result.json["problems"].back()["tile_id"] = *problem.tile_id;
  }
  if (!report.ok()) {
    result.exit_code = report.any_wrong_digest() ? kExitIntegrity : kExitFailed;
    return result;
  }
  result.text = path + ": intact; " + std::to_string(report.tiles) + " tiles, " + std::to_string(report.descriptors) +
                " descriptors, " + (report.chips > 0 ? std::to_string(report.chips) + " chips, " : "") +
                (report.landmarks > 0 ? std::to_string(report.landmarks) + " landmarks, " : "") + "digest " +
                report.content_digest + "\n";
  const MapReader map = input ? MapReader::open(input->map) : MapReader::open_unverified(path);
  check_purpose(map, required);
  add_purpose(map.purpose(), result);
  if (const auto warning = expiry_warning(map, options)) result.warnings.push_back(*warning);
  if (input) add_signature(input->map.signature(), input->key_list, result);
  return result;
}

constexpr std::uintmax_t kMaxManifestBytes = std::uintmax_t{16} << 20;

/// The signature of the manifest, the files that it names, and the map among them as any map.
CommandResult verify_pack(const std::filesystem::path& folder, const TrustOptions& options, const Progress& progress) {
  const std::filesystem::path path = folder / kPackManifestName;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    throw DataError(folder.string() + ": is a folder without " + kPackManifestName +
                    ", so no field pack; `pilotage prepare --outputs pack` makes one");
  }
  const SignedText manifest_text = read_signed_text(options, path, kMaxManifestBytes);
  const PackManifest manifest = pack_manifest_from_text(manifest_text.text, path.string());
  const PackCheck check = check_pack(folder, manifest, progress);
  CommandResult result;
  std::int64_t bytes = 0;
  for (const PackFile& file : manifest.files) bytes += file.bytes;
  result.json = {{"pack", folder.string()},
                 {"intact", check.problems.empty()},
                 {"verdict", manifest.verdict},
                 {"files", manifest.files.size()},
                 {"bytes", bytes},
                 {"problems", nlohmann::ordered_json::array()}};
  for (const PackProblem& problem : check.problems) {
    result.text += problem.message + "\n";
    result.json["problems"].push_back({{"file", problem.file}, {"message", problem.message}});
  }
  for (const std::string& name : check.strangers) {
    result.warnings.push_back((folder / name).string() + ": the manifest does not name it; it is no part of the pack");
  }
  if (!check.problems.empty()) {
    result.exit_code = kExitIntegrity;
    return result;
  }
  result.text = folder.string() + ": a pack of " + std::to_string(manifest.files.size()) + " files, all as written (" +
                format_fixed(static_cast<double>(bytes) / 1e6, 2) + " MB)\n" + manifest.verdict + "\n";
  if (manifest_text.signature) {
    add_signature(*manifest_text.signature, manifest_text.key_list, result);
  } else {
    result.warnings.push_back("whose pack it is was not checked: give --public-key or --key-list");
  }
  CommandResult map = verify_map_file((folder / kPackMapName).string(), options, progress);
  result.text += map.text;
  result.warnings.insert(result.warnings.end(), map.warnings.begin(), map.warnings.end());
  result.exit_code = map.exit_code;
  result.json["intact"] = map.json["intact"];
  if (map.exit_code == 0 && map.json["digest"] != manifest.map_digest) {
    throw IntegrityError((folder / kPackMapName).string() + ": is not the map that the manifest speaks of");
  }
  result.json["map"] = std::move(map.json);
  return result;
}

}  // namespace

Command make_verify_command() {
  Command command;
  command.word = "verify";
  command.group = CommandGroup::kInspect;
  command.summary = "Check every byte of a map or a field pack, and its signature";
  command.examples = {{"Everything but the signature.", "pilotage verify map.gpkg"},
                      {"With the signature.", "pilotage verify map.gpkg --public-key key.pub"},
                      {"A field pack: every file, and the map in it.", "pilotage verify pack/ --public-key key.pub"},
                      {"By a signed list of keys, for one mission.",
                       "pilotage verify map.gpkg --key-list keys.txt --root-key root.pub --mission harbour"}};
  command.inputs = {.name = "MAP", .help = "The map database, or the folder of a field pack.", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kNone, .help = "", .required = false};
  bind_options<TrustOptions>(command, [](const TrustOptions& options, const Invocation& invocation) {
    const std::string& path = invocation.inputs.front();
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored) ? verify_pack(path, options, invocation.progress)
                                                        : verify_map_file(path, options, invocation.progress);
  });
  return command;
}

}  // namespace pilotage
