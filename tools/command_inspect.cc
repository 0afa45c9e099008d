#include <algorithm>
#include <cctype>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <system_error>
#include <vector>

#include "commands.h"
#include "stage_files.h"
#include "standard_streams.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/map_inspect.h"
#include "pilotage/mapdb/map_verify.h"
#include "pilotage/mission/simulation_file.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/report/explain.h"
#include "pilotage/report/plan_report.h"
#include "pilotage/report/report_file.h"
#include "pilotage/report/simulated_flights.h"
#include "pilotage/route/describe_route.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/route_json.h"
#include "pilotage/verdict/evidence.h"

namespace pilotage {
namespace {

enum class InspectKind { kAuto, kMap, kRoute, kImagery, kOutputs };
EnumNames<InspectKind> enum_names(InspectKind) {
  return {{InspectKind::kAuto, "auto"},
          {InspectKind::kMap, "map"},
          {InspectKind::kRoute, "route"},
          {InspectKind::kImagery, "imagery"},
          {InspectKind::kOutputs, "outputs"}};
}

struct InspectOptions {
  InspectKind kind = InspectKind::kAuto;
  std::string explain;
  RouteOptions route;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("kind", self.kind, "What the file is; found out if not given.");
    fields.field(
        "explain", self.explain,
        "Of an output folder of prepare: say in words why the route (\"verdict\"), a leg (\"leg 3\") or a tile (\"tile "
        "1204\") is judged as it is.");
    RouteOptions::describe(self.route, fields);
  }
};

CommandResult inspect_map_file(const std::string& path) {
  const MapSummary summary = inspect_map(path);
  CommandResult result;
  result.json = to_json(summary);
  result.text = summary.file + ": map database, schema version " + std::to_string(summary.info.schema_version) + ", " +
                format_fixed(static_cast<double>(summary.file_bytes) / 1e6, 2) + " MB\nCRS: " + summary.info.crs.name +
                (summary.info.crs.authority.empty() ? "" : " (" + summary.info.crs.authority + ")") + "\n";
  for (const MapLevelSummary& level : summary.levels) {
    result.text += "level " + std::to_string(level.level.matrix.level) + ": " + format_fixed(level.level.gsd_m, 3) +
                   " m/px, " + std::to_string(level.tiles) + " tiles of " +
                   std::to_string(level.level.matrix.tile_size_px) + " px, " + std::to_string(level.descriptors) +
                   " descriptors in " + std::to_string(level.descriptor_blob_bytes) + " bytes";
    if (level.chips > 0) {
      result.text += ", " + std::to_string(level.chips) + " chips in " + std::to_string(level.chip_bytes) + " bytes";
    }
    result.text += "\n";
  }
  result.text += "route lines: " + std::to_string(summary.route_lines) + ", legs: " + std::to_string(summary.legs) +
                 (summary.landmark_classes.empty() ? ""
                                                   : "\nlandmarks: " + std::to_string(summary.landmarks) + " (" +
                                                         join(summary.landmark_classes, ", ") + ")") +
                 "\nbytes per tile: " + format_fixed(summary.bytes_per_tile, 0);
  if (summary.chip_bytes_per_tile > 0) {
    result.text += " (" + format_fixed(summary.descriptor_bytes_per_tile, 0) + " of descriptors, " +
                   format_fixed(summary.chip_bytes_per_tile, 0) + " of chips)";
  }
  result.text += "\n";
  for (const MapInfoEntry& entry : summary.info.entries) result.text += entry.key + " = " + entry.value + "\n";
  return result;
}

/// The lines of a file that could all be the route.
CommandResult list_routes(const std::string& path, const std::vector<RouteChoice>& choices) {
  CommandResult result;
  result.text = path + ": holds " + std::to_string(choices.size()) +
                " lines that could be the route; --feature NUMBER or NAME chooses one, --layer one of a layer\n";
  result.json = {{"file", path}, {"lines", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const RouteChoice& choice = choices[i];
    result.text += "  " + std::to_string(i + 1) + ": " + choice.what + " \"" + choice.name + "\" of layer \"" +
                   choice.layer + "\", " + std::to_string(choice.points) + " points\n";
    result.json["lines"].push_back({{"number", i + 1},
                                    {"what", choice.what},
                                    {"name", choice.name},
                                    {"layer", choice.layer},
                                    {"points", choice.points}});
  }
  return result;
}

CommandResult inspect_route_file(const std::string& path, const RouteOptions& options) {
  try {
    const Route route = path == kStandardStream
                            ? parse_route("standard input", read_standard_input(kMaxRouteBytes), options)
                            : read_route(path, options);
    CommandResult result;
    result.text = describe_route_text(route);
    result.json = route_to_json(route);
    return result;
  } catch (const SeveralRoutesError& error) {
    return list_routes(path, error.choices());
  }
}

CommandResult inspect_imagery_dataset(const std::string& dataset, const Progress& progress) {
  const ImageryInfo info = inspect_imagery(dataset, {}, progress);
  CommandResult result;
  result.text = info.dataset + ": " + info.driver + ", " + std::to_string(info.width_px) + " × " +
                std::to_string(info.height_px) + " px of " + info.band_type + ", " + join(info.band_colors, " ") +
                "\nCRS: " + info.crs.name() + (info.crs.authority().empty() ? "" : " (" + info.crs.authority() + ")") +
                "\nground sample distance: " + format_fixed(info.gsd_x_m, 4) + " × " + format_fixed(info.gsd_y_m, 4) +
                " m\ncentre: lon " + format_fixed(info.center.lon_deg, 7) + ", lat " +
                format_fixed(info.center.lat_deg, 7) + "\noverviews: " + std::to_string(info.overviews) +
                "\nacquired: " + (info.acquired.empty() ? "not said" : info.acquired) + "\n";
  result.json = {{"dataset", info.dataset},
                 {"driver", info.driver},
                 {"width_px", info.width_px},
                 {"height_px", info.height_px},
                 {"band_type", info.band_type},
                 {"band_colors", info.band_colors},
                 {"gray_bands", info.gray_bands},
                 {"crs", info.crs.name()},
                 {"authority", info.crs.authority()},
                 {"gsd_x_m", info.gsd_x_m},
                 {"gsd_y_m", info.gsd_y_m},
                 {"center_lon_deg", info.center.lon_deg},
                 {"center_lat_deg", info.center.lat_deg},
                 {"overviews", info.overviews},
                 {"acquired", info.acquired}};
  result.warnings = info.warnings;
  if (!looks_like_heights(info)) return result;
  try {
    const Elevation heights(dataset);
    result.text += "as an elevation model: heights " + heights.vertical_datum() + "\n";
    result.json["vertical_datum"] = heights.vertical_datum();
    const std::vector<GeodeticPoint> around{info.center};
    for (const UndeclaredVoid& found : heights.undeclared_voids(around)) {
      result.warnings.push_back(undeclared_void_text(dataset, found));
    }
  } catch (const DataError& error) {  // it may be something else
    result.warnings.push_back("it cannot be an elevation model: " + std::string(error.what()));
  }
  return result;
}

/// By the plan, scores and selection that lie in the folder of `report`; throws IntegrityError where they are another
/// run's.
std::vector<std::string> explain_outputs(const std::filesystem::path& folder, const Report& report,
                                         const std::string& what) {
  const auto file = [&](const char* name) { return (folder / name).string(); };
  const StageFiles files =
      read_stage_files(file("plan.json"), {.table = file("tiles.csv"), .selection = file("selection.json")});
  ReportInput input = make_report_input(files.mission, files.scores, files.selection);
  const auto flown = std::find_if(report.inputs.begin(), report.inputs.end(),
                                  [](const InputFile& one) { return one.role == "simulation"; });
  if (flown != report.inputs.end()) {
    const std::string name = file("simulation.json");
    need_file(name, "prepare");
    try {
      add_simulation(input, read_simulation(name), name,
                     simulated_inputs(file("plan.json"), file("tiles.csv"), file("selection.json")));
    } catch (const DataError& error) {
      throw IntegrityError(folder.string() +
                           ": plan.json, tiles.csv and selection.json are not those of report.json: " + error.what());
    }
  }
  const Report again = make_report(input);
  if (again.verdict_text != report.verdict_text) {
    throw IntegrityError(
        folder.string() + ": plan.json, tiles.csv and selection.json are not those of report.json: by them it is \"" +
        again.verdict_text + "\", report.json says \"" + report.verdict_text + "\"; run `pilotage prepare` again");
  }
  return explain(again, files.selection.advice, what);
}

/// The outputs of one run of `prepare`: the report must speak of the map that lies beside it.
CommandResult inspect_outputs(const std::filesystem::path& folder, const std::string& what, const Progress& progress) {
  const std::filesystem::path page = folder / "report.json";
  const std::filesystem::path map = folder / "map.gpkg";
  std::error_code ignored;
  for (const std::filesystem::path& path : {page, map}) {
    if (std::filesystem::exists(path, ignored)) continue;
    throw DataError(folder.string() + ": has no " + path.filename().string() +
                    ": give the output folder of `pilotage prepare`, or a file; what a killed run left is made whole "
                    "by running it again");
  }
  const Report report = read_report(page);
  const auto of_map = std::find_if(report.inputs.begin(), report.inputs.end(),
                                   [](const InputFile& input) { return input.role == "map"; });
  if (of_map == report.inputs.end()) {
    throw DataError(page.string() + ": names no map: it is of `pilotage report`, and `prepare` writes those that do");
  }
  const VerifyReport verified = verify_map(map, progress);
  require_intact(verified);
  const std::string digest = "blake2b-256:" + verified.content_digest;
  if (of_map->digest != digest) {
    throw IntegrityError(map.string() + ": is not the map that report.json speaks of: its digest is " + digest +
                         ", the report's " + of_map->digest + "; run `pilotage prepare` again");
  }
  const std::string evidence = evidence_line(report.quality);
  CommandResult result;
  result.text = folder.string() + ": the report speaks of the map beside it, which is intact; digest " +
                verified.content_digest + "\n" + report.verdict_text + "\n" + report.assumptions + "\n" + evidence +
                "\n";
  result.json = {{"folder", folder.string()},
                 {"map_digest", digest},
                 {"verdict", report.verdict_text},
                 {"assumptions", report.assumptions},
                 {"evidence", evidence}};
  if (what.empty()) return result;
  const std::vector<std::string> lines = explain_outputs(folder, report, what);
  result.text += "\n" + join(lines, "\n") + "\n";
  result.json["explained"] = what;
  result.json["explanation"] = lines;
  return result;
}

bool ends_with_any(std::string path, std::initializer_list<std::string_view> endings) {
  std::transform(path.begin(), path.end(), path.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) { return path.ends_with(ending); });
}

InspectKind kind_of(const std::string& path) {
  if (path == kStandardStream) return InspectKind::kRoute;
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::path(path) / "report.json", ignored)) return InspectKind::kOutputs;
  if (ends_with_any(path, {".gpkg"}) && declares_map(path)) return InspectKind::kMap;
  if (ends_with_any(path, {".plan", ".mission", ".waypoints", ".txt", ".poly", ".csv", ".kml", ".kmz", ".wpml", ".gpx",
                           ".geojson", ".json"})) {
    return InspectKind::kRoute;
  }
  if (ends_with_any(path, {".gpkg"})) {
    // Damaged maps are told apart from vector routes by what reading them as a map says.
    try {
      return read_route(path).vertices.empty() ? InspectKind::kMap : InspectKind::kRoute;
    } catch (const DataError&) {
      return InspectKind::kMap;
    }
  }
  return InspectKind::kImagery;
}

}  // namespace

Command make_inspect_command() {
  Command command;
  command.word = "inspect";
  command.group = CommandGroup::kInspect;
  command.summary = "Say what a map, a route, a raster or an output folder holds";
  command.examples = {{"A map database.", "pilotage inspect map.gpkg --json"},
                      {"A route, and what became of each of its items.", "pilotage inspect route.plan"},
                      {"Whether report and map are of one run.", "pilotage inspect out/"},
                      {"Why a leg is judged as it is.", "pilotage inspect out/ --explain \"leg 3\""},
                      {"What the verdict rests on.", "pilotage inspect out/ --explain verdict"}};
  command.inputs = {
      .name = "FILE",
      .help = "Map database, route file, GDAL dataset, or output folder of prepare; a route may be \"-\".",
      .min = 1,
      .max = 1,
      .may_stream = true};
  command.output = {.kind = OutputKind::kNone, .help = "", .required = false};
  command.reads_rasters = true;
  bind_options<InspectOptions>(command, [](const InspectOptions& options, const Invocation& invocation) {
    const std::string& path = invocation.inputs.front();
    const InspectKind kind = options.kind == InspectKind::kAuto ? kind_of(path) : options.kind;
    if (!options.explain.empty() && kind != InspectKind::kOutputs) {
      throw UsageError("explain = \"" + options.explain +
                       "\": legs and tiles are those of an output folder of prepare, and " + path + " is none");
    }
    if (path == kStandardStream && kind != InspectKind::kRoute) {
      throw UsageError("FILE = \"-\" is a route on standard input; a map, a raster or a folder needs its name");
    }
    switch (kind) {
      case InspectKind::kMap:
        return inspect_map_file(path);
      case InspectKind::kRoute:
        return inspect_route_file(path, options.route);
      case InspectKind::kOutputs:
        return inspect_outputs(path, options.explain, invocation.progress);
      default:
        return inspect_imagery_dataset(path, invocation.progress);
    }
  });
  return command;
}

}  // namespace pilotage
