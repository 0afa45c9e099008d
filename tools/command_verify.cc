#include <optional>

#include "commands.h"
#include "signed_input.h"

#include "pilotage/base/error.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

struct VerifyOptions {
  SignatureOptions signature;
  bool require_signature = false;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    SignatureOptions::describe(self.signature, fields);
    fields.field("require_signature", self.require_signature, "Refuse to check a map without --public-key.");
  }
};

}  // namespace

Command make_verify_command() {
  Command command;
  command.word = "verify";
  command.group = CommandGroup::kInspect;
  command.summary = "Check every byte of a map database, and its signature";
  command.examples = {{"Everything but the signature.", "pilotage verify map.gpkg"},
                      {"With the signature.", "pilotage verify map.gpkg --public-key key.pub"}};
  command.inputs = {.name = "MAP", .help = "The map database.", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kNone, .help = "", .required = false};
  bind_options<VerifyOptions>(command, [](const VerifyOptions& options, const Invocation& invocation) {
    const std::string& path = invocation.inputs.front();
    if (options.require_signature && !options.signature.public_key) {
      throw UsageError("--require-signature needs --public-key: a signature is checked with a key");
    }
    const std::optional<SignedMap> signed_map = read_signed_input(options.signature, path);
    const VerifyReport report =
        signed_map ? verify_map(*signed_map, invocation.progress) : verify_map(path, invocation.progress);
    CommandResult result;
    result.json = {{"map", path},
                   {"intact", report.ok()},
                   {"tiles", report.tiles},
                   {"descriptor_rows", report.descriptor_rows},
                   {"descriptors", report.descriptors},
                   {"chips", report.chips},
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
                  " descriptors, " + (report.chips > 0 ? std::to_string(report.chips) + " chips, " : "") + "digest " +
                  report.content_digest + "\n";
    if (signed_map) {
      const SignatureInfo& signature = signed_map->signature();
      result.text += "signed by key " + signature.key_id + ", " + signature.trusted_comment + "\n";
      result.json["signature"] = {{"key_id", signature.key_id}, {"trusted_comment", signature.trusted_comment}};
    }
    return result;
  });
  return command;
}

}  // namespace pilotage
