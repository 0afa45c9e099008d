#include <filesystem>
#include <optional>

#include "commands.h"
#include "signed_input.h"
#include "stage_files.h"

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/map_delta.h"
#include "pilotage/pack/field_pack.h"

namespace pilotage {

Command make_update_command() {
  Command command;
  command.word = "update";
  command.group = CommandGroup::kInspect;
  command.summary = "Make a newer map database out of an older one and a delta";
  command.examples = {{"What `--update` of build or prepare made, with its signature checked.",
                       "pilotage update map.gpkg new.gpkg.delta -o updated.gpkg --public-key key.pub"}};
  command.inputs = {.name = "MAP DELTA", .help = "The map database that is there, and the delta.", .min = 2, .max = 2};
  command.output = {.kind = OutputKind::kFile,
                    .help = "The new map database; its signature and list of chunks stand beside it.",
                    .files = [](const std::string& output) -> std::vector<std::filesystem::path> {
                      return {output, signature_path_of(output), chunk_list_path_of(output)};
                    }};
  bind_options<TrustOptions>(command, [](const TrustOptions& options, const Invocation& invocation) {
    const std::string& old_map = invocation.inputs[0];
    const std::string& delta = invocation.inputs[1];
    need_file(old_map, "build` or `pilotage prepare");
    need_file(delta, "build --update` or `pilotage prepare --update");
    const TrustedKeys trusted = checked_keys_of(options);
    if (options.signature) throw UsageError("--signature: those of a delta and of its map have their places");
    MapUpdateOptions update;
    update.trusted_keys = trusted.keys;
    update.required = requirements_of(options);
    update.overwrite = invocation.overwrite;
    const MapUpdate made = update_map(old_map, delta, invocation.output, update, invocation.progress);
    CommandResult result;
    result.text = invocation.output + ": " + format_fixed(static_cast<double>(made.bytes) / 1e6, 2) +
                  " MB, BLAKE2b-256 " + made.digest + "\n";
    result.json = {{"output", invocation.output}, {"bytes", made.bytes}, {"digest", made.digest}};
    if (const std::string text = purpose_text(made.purpose); !text.empty()) {
      result.text += text + "\n";
      result.json["purpose"] = purpose_to_json(made.purpose);
    }
    if (made.signature) {
      add_signature(*made.signature, trusted.list, result);
    } else {
      result.warnings.emplace_back("whose delta and map they are was not checked: give --public-key or --key-list");
    }
    const MapReader map = MapReader::open_unverified(invocation.output);
    if (const auto warning = expiry_warning(map, options)) result.warnings.push_back(*warning);
    return result;
  });
  return command;
}

}  // namespace pilotage
