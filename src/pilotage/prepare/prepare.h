#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/build_map/purpose_options.h"
#include "pilotage/gis/report_outputs.h"
#include "pilotage/mapdb/map_delta_writer.h"
#include "pilotage/mapdb/map_signing.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/simulation.h"
#include "pilotage/score/score_tiles.h"
#include "pilotage/select/select_options.h"
#include "pilotage/tile/tile_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A mission: what tile, score, select and build need. mission.json has these keys.
struct PrepareOptions {
  TileOptions tile;
  ScoreOptions score;
  SelectOptions select;
  BuildOptions build;
  PurposeOptions purpose;
  std::int64_t flights = 2000;
  std::vector<ReportOutput> outputs{ReportOutput::kHtml, ReportOutput::kJson, ReportOutput::kCog, ReportOutput::kGpkg};

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    TileOptions::describe(self.tile, fields);
    fields.group("score", self.score, "How tiles are scored.", FlagPrefix::kNone);
    fields.group("select", self.select, "Which tiles become matching areas.", FlagPrefix::kNone);
    fields.group("build", self.build, "What is stored of them.", FlagPrefix::kNone);
    fields.group("purpose", self.purpose, "What the map says that it is for.", FlagPrefix::kNone);
    fields.field("flights", self.flights,
                 "How many drawn flights the plan is flown by before it is judged (simulation.json); 0: none.",
                 Range{0, 1000000});
    fields.field("outputs", self.outputs, outputs_help());
  }
};

/// Where the outputs go, and how the work is done.
struct PrepareRun {
  std::filesystem::path output_folder;
  bool overwrite = false;
  std::uint64_t seed = 1;
  int threads = 0;
  std::string software_version;
  std::optional<std::filesystem::path> secret_key;  ///< Map and manifest are signed with it (mapdb/map_signing.h).
  SignOptions sign;                                 ///< With `secret_key`; its paths are the output folder's.
  /// The map that is there: what turns it into the new one is written, too (mapdb/map_delta.h).
  std::optional<std::filesystem::path> update{};
};

struct PrepareResult {
  std::string verdict;      ///< The report's first sentence.
  std::string assumptions;  ///< What it takes for granted, as the report says it.
  std::string evidence;     ///< What it rests on (verdict/evidence.h), in one line.
  std::string holds;        ///< How long the map holds (verdict/map_holds.h), a sentence; "" where nothing is known.
  BuildStats map;
  std::optional<MapDifference> difference;  ///< From PrepareRun::update; nothing where no tile can be the same.
  std::int64_t planned_tiles = 0;
  std::int64_t selected_tiles = 0;
  double matchable_fraction = 0;
  bool within_limit = false;
  bool meets_gate = false;            ///< The verdict is not NO-GO: what `require` asks for.
  std::vector<std::string> files;     ///< Written, in the output folder.
  std::vector<std::string> warnings;  ///< For the planner.
};

/// How tiles are scored for the map that will be built: P(correct fix) is that of its features and chips. Throws
/// UsageError for a matcher that the map does not serve.
ScoreOptions score_options_of(const PrepareOptions& options);

/// The files that are written: those that are asked for, and those that a field pack is made of where one is.
std::vector<ReportOutput> outputs_of(const PrepareOptions& options);

/// Names of the outputs of an earlier run in a folder, sorted: what prepare() replaces there, and a signature and a
/// list of chunks of the map.
std::vector<std::string> earlier_outputs(const std::filesystem::path& folder);

/// Flies a plan `options.flights` times with drawn fixes, as `simulate` does without other options; nothing where none
/// are asked for, or where the selection has no P to hold them against.
std::optional<Simulation> fly_plan(const Mission& mission, const std::vector<TileScores>& scores,
                                   const Selection& selection, const PrepareOptions& options, std::uint64_t seed,
                                   int threads, const Progress& progress = {});

/// The main job: tile → score → select → fly → build → report. Writes plan.json, tiles.csv, scores.tif
/// (scores_level1.tif … for further levels; with their styles for QGIS when `outputs` ask for cog), disagreement.tif
/// (with score.second_epoch), selection.json, simulation.json (of fly_plan), map.gpkg and the files of the report that
/// `outputs` ask for, "report.html" and so on, and with a secret key map.gpkg.minisig and for a large map
/// map.gpkg.chunks; with a map to update map.gpkg.delta and with a key its signature; with outputs that ask for a pack
/// also the route as it was planned (pack_route with its ending), the manifest of all (pack/field_pack.h) and its
/// signature; into the output folder, which is made when it does not exist. All of them appear at the end, in place of
/// those of an earlier run, the map last: at no moment an output of the one stands beside one of the other
/// (base/output_file.h, replace_together). When anything fails, those of the earlier run stand there as before. Throws
/// as the stages; DataError when an output exists and overwrite is not set.
PrepareResult prepare(const PrepareOptions& options, const PrepareRun& run, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
