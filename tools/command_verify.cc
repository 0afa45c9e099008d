#include <optional>

#include "commands.h"
#include "signed_input.h"

#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

/// What the map says that it is for.
nlohmann::ordered_json to_json(const MapPurpose& purpose) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (purpose.mission_name) json["mission_name"] = *purpose.mission_name;
  if (purpose.map_version) json["map_version"] = *purpose.map_version;
  if (purpose.created) json["created"] = format_utc_time(*purpose.created);
  if (purpose.valid_until) json["valid_until"] = format_utc_time(*purpose.valid_until);
  return json;
}

void add_purpose(const MapPurpose& purpose, CommandResult& result) {
  const std::string text = purpose_text(purpose);
  if (text.empty()) return;
  result.text += text + "\n";
  result.json["purpose"] = to_json(purpose);
}

void add_signature(const SignedInput& input, CommandResult& result) {
  const SignatureInfo& signature = input.map.signature();
  result.text += "signed by key " + signature.key_id + ", " + signature.trusted_comment + "\n";
  result.json["signature"] = {{"key_id", signature.key_id}, {"trusted_comment", signature.trusted_comment}};
  if (!input.key_list) return;
  const KeyList& list = *input.key_list;
  const ListedKey* const signer = list.find_signer(signature.key_id);
  if (signer == nullptr) return;  // cannot be: the list gave the keys
  const std::string valid_until = format_utc_time(list.valid_until);
  result.text += "trusted by key list version " + std::to_string(list.version) + ", valid until " + valid_until + ": " +
                 signer->name + "\n";
  result.json["key_list"] = {{"version", list.version}, {"valid_until", valid_until}, {"signer", signer->name}};
}

}  // namespace

Command make_verify_command() {
  Command command;
  command.word = "verify";
  command.group = CommandGroup::kInspect;
  command.summary = "Check every byte of a map database, and its signature";
  command.examples = {{"Everything but the signature.", "pilotage verify map.gpkg"},
                      {"With the signature.", "pilotage verify map.gpkg --public-key key.pub"},
                      {"By a signed list of keys, for one mission.",
                       "pilotage verify map.gpkg --key-list keys.txt --root-key root.pub --mission harbour"}};
  command.inputs = {.name = "MAP", .help = "The map database.", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kNone, .help = "", .required = false};
  bind_options<TrustOptions>(command, [](const TrustOptions& options, const Invocation& invocation) {
    const std::string& path = invocation.inputs.front();
    const MapRequirements required = requirements_of(options);
    const std::optional<SignedInput> input = read_signed_input(options, path);
    const VerifyReport report =
        input ? verify_map(input->map, invocation.progress) : verify_map(path, invocation.progress);
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
    if (input) add_signature(*input, result);
    return result;
  });
  return command;
}

}  // namespace pilotage
