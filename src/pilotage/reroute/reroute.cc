#include "pilotage/reroute/reroute.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <system_error>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/reroute/judged_line.h"
#include "pilotage/reroute/line_finder.h"
#include "pilotage/reroute/planned_line.h"
#include "pilotage/reroute/reroute_files.h"
#include "pilotage/reroute/reroute_page.h"
#include "pilotage/route/dji_wpml_writer.h"
#include "pilotage/route/read_route.h"
#include "pilotage/score/score_ground.h"
#include "pilotage/tile/plan_tiles.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr double kMostTilesByDefault = 6000;
constexpr int kMostVerified = 4;
constexpr const char* kPlan = ".plan";
constexpr const char* kDjiMission = ".kmz";

// Only what P(correct fix) needs is measured of the ground around the line, where that is what tiles are chosen by.
ScoreOptions search_scores(ScoreOptions options) {
  if (options.measure(ScoreMeasure::kCorrectFix)) options.measures = {ScoreMeasure::kCorrectFix};
  options.second_epoch.clear();
  return options;
}

// How far from the line to search unless the planner says: a quarter of its length, as far as the tiles are few enough.
double default_within_m(const Mission& mission) {
  const double length_m = mission.flight.samples.back().distance_m;
  double stride_m = 1;
  for (const GridLevel& level : mission.ground.levels) {
    stride_m = std::max(stride_m, level.matrix.stride_px * level.gsd_m);
  }
  // 2·d·length + π·d² = tiles · stride²
  const double area_m2 = kMostTilesByDefault * stride_m * stride_m;
  const double few_m = (std::sqrt(length_m * length_m + std::numbers::pi * area_m2) - length_m) / std::numbers::pi;
  return std::max({std::min(length_m / 4, few_m), 4 * stride_m, mission.flight.corridor_half_width_m});
}

void check_line_options(const RerouteOptions& options) {
  check_options(options);
  const LineOptions& line = options.line;
  if (line.from.empty() != line.to.empty()) throw UsageError("from and to belong together; one of them is missing");
  if (!line.from.empty() && (!line.keep.empty() || line.keep_waypoints)) {
    throw UsageError("from and to have no legs and no waypoints to keep");
  }
  if (line.from.empty() && options.mission.tile.route.empty()) {
    throw UsageError("route is missing; give it as --route, or in a mission file, or two points by --from and --to");
  }
  if (!options.mission.tile.denied) return;
  for (const std::string& text : *options.mission.tile.denied) {
    std::error_code ignored;
    if (text == "all" || text == "anywhere" || fs::exists(text, ignored)) continue;
    throw UsageError("denied = \"" + name_as_utf8(text) +
                     "\" is a stretch of the planned line, which another line does not have; give the polygon");
  }
}

constexpr int kPictureSide_px = 1000;

DegreePicture overview_in_degrees(const Ground& ground) {
  const Raster overview = read_overview(ground, kPictureSide_px);
  cv::Mat rgba;
  cv::merge(std::vector<cv::Mat>{overview.pixels, overview.valid}, rgba);
  return picture_in_degrees(rgba, ground.crs, overview.map_from_pixel, 1, kPictureSide_px);
}

}  // namespace

std::vector<fs::path> reroute_outputs(const fs::path& output) {
  std::vector<fs::path> files = {output};
  std::vector<std::string> endings = {".json", ".geojson", ".html"};
  if (output.extension() != kPlan) endings.insert(endings.begin(), kPlan);
  for (const std::string& ending : endings) files.push_back(fs::path(output).replace_extension(ending));
  return files;
}

RerouteResult reroute(const RerouteOptions& given, const RerouteRun& run, const Progress& progress) {
  check_line_options(given);
  if (run.output.extension() != kPlan && run.output.extension() != kDjiMission) {
    throw UsageError(name_as_utf8(run.output.string()) +
                     ": the new route is a QGroundControl plan, named *.plan, or a DJI mission besides, named *.kmz");
  }
  const std::vector<fs::path> outputs = reroute_outputs(run.output);
  for (const fs::path& file : outputs) {
    if (!run.overwrite && fs::exists(fs::symlink_status(file))) {
      throw DataError(name_as_utf8(file.string()) + ": exists already; give --overwrite to replace it");
    }
  }
  const fs::path folder = run.output.has_parent_path() ? run.output.parent_path() : fs::path(".");
  const StagingFolder staging(folder);
  RerouteOptions options = given;
  RerouteResult result;
  if (!options.line.from.empty()) {
    const fs::path direct = staging / "from and to.plan";
    write_file(direct, json_text(plan_of_points(options.line, options.mission.tile.route_options), 4), true);
    options.mission.tile = options_for_plan(options.mission.tile, direct);
  }

  const Route route = read_route(options.mission.tile.route, options.mission.tile.route_options);
  if (run.output.extension() == kDjiMission) dji_mission_of(route, "");  // what it cannot hold, before the work
  const PlannedLine planned = read_planned_line(options.mission.tile, options.line, route, result.notes);
  const NoFlyZones zones = read_zones(planned, options.line);
  TileOptions as_planned = options.mission.tile;
  as_planned.allow_uncovered = true;  // a planned line that leaves the imagery is what another one is looked for
  constexpr int kParts = 3;
  const Progress judging = part_of(progress, 1, kParts);
  const Progress searching = part_of(progress, 2, kParts);
  const Progress verifying = part_of(progress, 3, kParts);
  const JudgedLine before = judge_as_prepare(options.mission, as_planned, run, judging);
  result.warnings = before.mission.warnings;

  TileOptions around = options.mission.tile;
  result.search_within_m = options.line.search_within_m.value_or(default_within_m(before.mission));
  if (options.line.keep_within_m) {
    // One tile more, so that the line may lead as far as it is allowed to.
    result.search_within_m =
        std::min(result.search_within_m, *options.line.keep_within_m + before.mission.flight.footprint_width_m);
  }
  around.corridor_half_width_m = result.search_within_m;
  around.denied.reset();
  around.allow_uncovered = true;
  Mission area = plan_tiles(around, searching);
  result.tiles = static_cast<std::int64_t>(area.ground.tiles.size());
  result.imagery = overview_in_degrees(area.ground);
  std::vector<TileScores> scores =
      score_ground(area.ground, search_scores(score_options_of(options.mission)), run.seed, run.threads, searching)
          .scores;
  LineFinder finder(options, planned, std::move(area), std::move(scores), zones,
                    before.mission.flight.corridor_half_width_m, run.threads, searching);
  for (const MovableRun& moved : finder.runs()) {
    for (std::size_t leg = moved.first; leg <= moved.last; ++leg) result.moved_legs.push_back(static_cast<int>(leg));
  }
  std::vector<LineCandidate> tried = finder.find_lines();
  result.lines_tried = static_cast<int>(tried.size());
  if (tried.empty()) {
    throw DataError("no line leads from the start to the end over imagery and clear of no-fly zones within " +
                    format_fixed(options.line.keep_within_m.value_or(result.search_within_m), 0) +
                    " m of the planned one; look at --search-within-m, --keep-within-m and --avoid");
  }
  // Those predicted GO by cost, then the others, the safest first.
  std::stable_sort(tried.begin(), tried.end(), [](const LineCandidate& a, const LineCandidate& b) {
    const bool a_go = a.predicted.status == QualityStatus::kGood;
    const bool b_go = b.predicted.status == QualityStatus::kGood;
    if (a_go != b_go) return a_go;
    return a_go ? a.cost_m < b.cost_m : is_safer(a.predicted, b.predicted);
  });

  std::optional<JudgedLine> after;
  const LineCandidate* chosen = nullptr;
  std::string refused;
  const std::string name = run.output.filename().replace_extension(kPlan).string();
  for (const LineCandidate& line : tried) {
    const bool go = line.predicted.status == QualityStatus::kGood;
    if (result.lines_verified == kMostVerified || (chosen != nullptr && !go)) break;
    write_file(staging / name, json_text(line.plan.json, 4), true);
    ++result.lines_verified;
    JudgedLine verified;
    try {
      verified =
          judge_as_prepare(options.mission, options_for_plan(options.mission.tile, staging / name), run, verifying);
    } catch (const DataError& error) {  // what `prepare` would refuse: a hole in the imagery, GNSS all the way
      refused = error.what();
      continue;
    }
    const ForbiddenWay forbidden = forbidden_way(zones, verified.mission.flight.samples);
    if (forbidden.length_m > 0) {
      refused = name + ": leads " + format_fixed(forbidden.length_m, 1) +
                " m through a no-fly zone or out of the fence (" + forbidden.source + ")";
      continue;
    }
    const bool is_better = !after || is_safer(verified, *after);
    const bool is_go = verified.status == QualityStatus::kGood;
    if (is_better) {
      after = std::move(verified);
      chosen = &line;
    }
    if (is_go) break;
  }
  if (chosen == nullptr) throw DataError("no line that was found can be flown; of the last: " + refused);
  MovedPlan plan = chosen->plan;
  const bool planned_is_clear = !(forbidden_way(zones, before.mission.flight.samples).length_m > 0);
  if (after->status != QualityStatus::kGood && planned_is_clear && !is_safer(*after, before)) {
    after = before;
    plan = MovedPlan{planned.json, {}, {}, {}};
    result.notes.emplace_back("no line that was found is better than the planned one, which stays as it is");
  }
  write_file(staging / name, json_text(plan.json, 4), true);

  result.found_go = after->status == QualityStatus::kGood;
  result.before = figures_of(before, zones);
  result.after = figures_of(*after, zones);
  result.assumptions = assumptions_line(after->mission, after->selection);
  if (!after->second_date.empty()) result.notes.push_back(after->second_date);
  result.removed_items = plan.removed;
  result.lost_items = plan.lost;
  result.shifted_items = plan.shifted;
  for (const std::string& warning : after->mission.warnings) {
    if (std::find(result.warnings.begin(), result.warnings.end(), warning) == result.warnings.end()) {
      result.warnings.push_back(warning);
    }
  }
  result.searched = finder.searched();
  for (const FlyZone& zone : zones.zones) {
    auto& rings = zone.inclusion ? result.fence_rings : result.no_fly_rings;
    rings.insert(rings.end(), zone.area.rings.begin(), zone.area.rings.end());
  }
  for (const fs::path& file : outputs) result.files.push_back(file.filename().string());
  const std::string stem = fs::path(name).stem().string();
  write_file(staging / (stem + ".json"), json_text(reroute_to_json(result)), true);
  write_file(staging / (stem + ".geojson"), json_text(reroute_to_geojson(result)), true);
  write_file(staging / (stem + ".html"), reroute_to_html(result, planned.name, stem + ".json"), true);
  if (run.output.extension() == kDjiMission) {
    const TileOptions rerouted = options_for_plan(options.mission.tile, staging / name);
    const Route flown = read_route(rerouted.route, rerouted.route_options);
    write_dji_mission(staging / run.output.filename(),
                      dji_mission_of(flown, camera_product_of(options.mission.tile.camera.name, route)), true);
  }
  std::vector<std::string> last_the_plan = result.files;
  std::rotate(last_the_plan.begin(), last_the_plan.begin() + 1, last_the_plan.end());
  staging.publish(last_the_plan, result.files);
  return result;
}

}  // namespace pilotage
