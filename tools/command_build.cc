#include <filesystem>
#include <optional>
#include <vector>

#include "commands.h"
#include "map_delta_result.h"
#include "map_size.h"
#include "sign_key_options.h"
#include "stage_files.h"
#include "version.h"

#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/build_map/purpose_options.h"
#include "pilotage/mapdb/map_delta.h"
#include "pilotage/mapdb/map_delta_writer.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mapdb/map_signing.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

struct BuildCommandOptions {
  StageFileOptions files;
  SignKeyOptions signing;
  std::vector<std::string> second_epoch;
  RegistrationOptions registration;
  BuildOptions build;
  PurposeOptions purpose;
  std::string update;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    SignKeyOptions::describe(self.signing, fields);
    BuildOptions::describe(self.build, fields);
    PurposeOptions::describe(self.purpose, fields);
    fields.path("second_epoch", self.second_epoch,
                "Imagery of the same ground at another date, for keep_features; give what `score` was given.");
    fields.path("update", self.update, kUpdateHelp);
    fields.group("registration", self.registration, "How the second date is brought onto the reference.");
  }
};

// The files of the plan and of the second date, as `prepare` lists them.
std::vector<InputFile> inputs_of(const Mission& mission, const BuildCommandOptions& options) {
  std::vector<InputFile> inputs = input_files(mission);
  for (const std::string& dataset : options.second_epoch) {
    const ImageryInfo info = inspect_imagery(dataset, second_date_options(mission.ground.imagery.options));
    inputs.push_back(input_dataset("second_epoch", dataset, info.acquired, info.licence));
  }
  if (!options.build.landmarks.empty()) inputs.push_back(input_file("landmarks", options.build.landmarks, ""));
  return inputs;
}

// Nothing is registered when nothing asks for it.
std::optional<SecondDate> second_date_of(const BuildCommandOptions& options, const Mission& mission,
                                         const Invocation& invocation) {
  if (options.build.keep_features == KeepFeatures::kAll || options.second_epoch.empty()) return std::nullopt;
  return register_second_date(mission.ground, options.second_epoch, options.registration, invocation.threads,
                              invocation.progress);
}

std::string landmarks_text(const BuildStats& stats) {
  if (stats.detectors == 0) return {};
  return std::to_string(stats.landmarks) + " landmarks of " + std::to_string(stats.detectors) +
         (stats.detectors == 1 ? " class\n" : " classes\n");
}

}  // namespace

Command make_build_command() {
  Command command;
  command.word = "build";
  command.group = CommandGroup::kStages;
  command.summary = "Write the onboard map database";
  command.examples = {
      {"From the files of the stages before.",
       "pilotage build plan.json --table tiles.csv --selection selection.json -o map.gpkg"},
      {"Signed.",
       "pilotage build plan.json --table tiles.csv --selection selection.json --sign-key key.sec -o map.gpkg"},
      {"Saying what it is for.",
       "pilotage build plan.json --table tiles.csv --selection selection.json --mission-name harbour --map-version 7 "
       "--created now --valid-until 2027-01-01T00:00:00Z -o map.gpkg"},
      {"Without the features that another date contradicts.",
       "pilotage build plan.json --table tiles.csv --selection selection.json --second-epoch other.tif "
       "--keep-features stable -o map.gpkg"},
      {"Also what turns the map that is there into the new one, for aircraft that have it.",
       "pilotage build plan.json --table tiles.csv --selection selection.json --update map.gpkg --sign-key key.sec -o "
       "new.gpkg"},
      {"With landmarks.",
       "pilotage build plan.json --table tiles.csv --selection selection.json --landmarks map_landmarks.json -o "
       "map.gpkg"}};
  command.inputs = {.name = "PLAN", .help = "The tile plan (plan.json).", .min = 1, .max = 1};
  command.output = {
      .kind = OutputKind::kFile,
      .help = "The map database (GeoPackage).",
      .files = [](const std::string& output) -> std::vector<std::filesystem::path> {
        const std::filesystem::path delta = map_delta_path_of(output);
        return {output, signature_path_of(output), chunk_list_path_of(output), delta, signature_path_of(delta)};
      }};
  command.reads_rasters = true;
  bind_options<BuildCommandOptions>(command, [](const BuildCommandOptions& options, const Invocation& invocation) {
    const std::optional<std::string>& sign_key = options.signing.sign_key;
    SignOptions sign = checked_sign_options(options.signing);
    const MapPurpose purpose = make_purpose(options.purpose);
    const StageFiles files = read_stage_files(invocation.inputs.front(), options.files);
    OutputFile map(invocation.output, invocation.overwrite);  // appears when it is signed, too
    // An old signature must not stand beside a new map, so it is an output even when nothing is signed; likewise a list
    // of chunks.
    OutputFile signature(signature_path_of(invocation.output), invocation.overwrite);
    OutputFile chunk_list(chunk_list_path_of(invocation.output), invocation.overwrite);
    OutputFile delta(map_delta_path_of(invocation.output), invocation.overwrite);
    OutputFile delta_signature(signature_path_of(delta.destination()), invocation.overwrite);
    if (!options.update.empty()) {
      need_file(options.update, "build` or `pilotage prepare");
      check_map_to_update(options.update, purpose);
    }
    const BuildStats stats =
        build_map(map.temporary_path(), files.mission, files.scores, files.selection, inputs_of(files.mission, options),
                  version_line(), options.build, true, invocation.threads, invocation.progress,
                  second_date_of(options, files.mission, invocation), nullptr, purpose);
    std::vector<const OutputFile*> outputs;
    std::vector<std::filesystem::path> stale;
    sign.signature_path = signature.temporary_path();
    sign.chunk_list_path = chunk_list.temporary_path();
    const bool has_list = sign_key && sign_file(map.temporary_path(), *sign_key, sign).chunk_list.has_value();
    const bool updates = !options.update.empty();
    if (updates) {
      write_map_delta(delta.temporary_path(), options.update, map.temporary_path(),
                      sign_key ? std::optional(signature.temporary_path()) : std::nullopt,
                      has_list ? std::optional(chunk_list.temporary_path()) : std::nullopt, invocation.progress);
      if (sign_key) {
        sign_whole_file(delta.temporary_path(), delta_signature.temporary_path(), *sign_key, sign);
      }
    }
    for (const auto& [output, is_written] :
         {std::pair(&delta, updates), std::pair(&delta_signature, updates && sign_key.has_value())}) {
      if (is_written) {
        outputs.push_back(output);
      } else {
        stale.push_back(output->destination());
      }
    }
    if (has_list) {
      outputs.push_back(&chunk_list);
    } else {
      stale.push_back(chunk_list.destination());
    }
    if (sign_key) {
      outputs.push_back(&signature);
    } else {
      stale.push_back(signature.destination());
    }
    outputs.push_back(&map);  // last: where it stands, its signature does
    const std::optional<MapDifference> difference =
        updates ? difference_of_maps(options.update, map.temporary_path()) : std::nullopt;
    OutputFile::commit(outputs, stale);
    CommandResult result;
    result.text = std::to_string(stats.tiles) + " tiles, " + std::to_string(stats.descriptors) + " descriptors, " +
                  format_fixed(static_cast<double>(stats.bytes) / 1e6, 2) + " MB\n" + bytes_per_tile_text(stats) +
                  kept_features_text(stats) + landmarks_text(stats) + "digest " + stats.content_digest + "\n";
    result.json = {{"output", invocation.output},  {"tiles", stats.tiles}, {"descriptors", stats.descriptors},
                   {"landmarks", stats.landmarks}, {"bytes", stats.bytes}, {"digest", stats.content_digest}};
    add_bytes_per_tile(stats, result.json);
    add_kept_features(stats, result.json);
    if (!options.second_epoch.empty() && !stats.stable) {
      result.warnings.push_back("--second-epoch changes no feature without --keep-features stable");
    }
    if (sign_key) {
      result.text += "signed: " + signature.destination().string() + "\n";
      result.json["signature"] = signature.destination().string();
    }
    if (has_list) {
      result.text += "chunks: " + chunk_list.destination().string() + "\n";
      result.json["chunk_list"] = chunk_list.destination().string();
    }
    if (updates) add_map_delta(options.update, delta.destination(), difference, result);
    return result;
  });
  return command;
}

}  // namespace pilotage
