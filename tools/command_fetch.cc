#include <filesystem>
#include <string>

#include "commands.h"

#include "pilotage/base/text.h"
#include "pilotage/fetch/fetch_imagery.h"
#include "pilotage/mission/licence_json.h"

namespace pilotage {
namespace {

nlohmann::ordered_json fetched_json(const FetchedFile& file) {
  nlohmann::ordered_json json{{"name", file.name},     {"item", file.asset.item},
                              {"source", file.source}, {"acquired", file.asset.acquired},
                              {"bytes", file.bytes},   {"kept", file.kept}};
  add_licence(file.asset.licence, json);
  return json;
}

}  // namespace

Command make_fetch_command() {
  Command command;
  command.word = "fetch";
  command.group = CommandGroup::kPrepare;
  command.summary = "Fetch imagery along a route from a STAC catalogue";
  command.examples = {{"From a catalogue on this machine or in the office.",
                       "pilotage fetch catalogue/collection.json --route route.plan -o imagery/"},
                      {"Over the network, a rectangle; call it again after an interruption.",
                       "pilotage fetch https://example.org/stac/collection.json --allow-network --bounds-deg "
                       "16.48,55.49,16.53,55.51 -o imagery/"}};
  command.inputs = {.name = "STAC",
                    .help = "STAC items, collections or catalogues: files, /vsicurl/… or addresses.",
                    .min = 1,
                    .max = InputSpec::kMany};
  command.output = {.kind = OutputKind::kFolder,
                    .help = "Folder for a GeoTIFF of each item, and fetched.json; what is whole there is kept."};
  command.reads_rasters = true;
  bind_options<FetchOptions>(command, [](const FetchOptions& options, const Invocation& invocation) {
    const FetchResult fetched =
        fetch_imagery(invocation.inputs, options, invocation.output, invocation.overwrite, invocation.progress);
    CommandResult result;
    result.warnings = fetched.warnings;
    std::int64_t bytes = 0;
    std::int64_t kept = 0;
    nlohmann::ordered_json files = nlohmann::ordered_json::array();
    for (const FetchedFile& file : fetched.files) {
      bytes += file.bytes;
      kept += file.kept ? 1 : 0;
      files.push_back(fetched_json(file));
      const std::string licence = licence_text(file.asset.licence);
      result.text += (std::filesystem::path(invocation.output) / file.name).string() + ": " +
                     std::to_string(file.window.width) + " x " + std::to_string(file.window.height) + " px of " +
                     file.asset.item + (licence.empty() ? "" : ", " + licence) + "\n";
      if (file.asset.licence.terms.empty()) {
        result.warnings.push_back(file.name + ": neither its item nor its collection names a licence");
      }
    }
    result.text += std::to_string(fetched.files.size()) + " files, " +
                   format_fixed(static_cast<double>(bytes) / 1e6, 2) + " MB" +
                   (kept > 0 ? "; " + std::to_string(kept) + " were there" : "") + "\n";
    const DegreeBounds& b = fetched.bounds;
    result.json = {{"output", invocation.output},
                   {"bounds_deg", {b.west_deg, b.south_deg, b.east_deg, b.north_deg}},
                   {"files", files},
                   {"bytes", bytes},
                   {"outside", fetched.outside}};
    return result;
  });
  return command;
}

}  // namespace pilotage
