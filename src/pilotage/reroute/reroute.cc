#include "pilotage/reroute/reroute.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/report/verdict.h"
#include "pilotage/reroute/line_search.h"
#include "pilotage/reroute/no_fly_zones.h"
#include "pilotage/reroute/reroute_files.h"
#include "pilotage/reroute/search_ground.h"
#include "pilotage/reroute/straighten_line.h"
#include "pilotage/route/qgc_geofence.h"
#include "pilotage/route/qgc_plan.h"
#include "pilotage/route/qgc_plan_writer.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/sample_route.h"
#include "pilotage/score/score_ground.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/tile/plan_tiles.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kMostTilesByDefault = 6000;
constexpr double kTurn_deg = 5;
constexpr double kOnePlace_m = 1;
constexpr double kSampleStep_m = 10;       // as plan_tiles
constexpr double kLowestShareOfAgl = 0.8;  // of the planned height above ground, before a waypoint is put in
constexpr int kMostHeightPoints = 32;
constexpr int kMostVerified = 4;
constexpr int kMostTries = 9;

std::string place_text(GeodeticPoint point) {
  return "lon " + format_fixed(point.lon_deg, 6) + ", lat " + format_fixed(point.lat_deg, 6);
}

GeodeticPoint point_of(const std::vector<double>& lon_lat, const char* option) {
  if (lon_lat.size() != 2) {
    throw UsageError(std::string(option) + " has " + std::to_string(lon_lat.size()) +
                     " numbers; it is a longitude and a latitude, as 16.4843,55.4950");
  }
  if (!(std::abs(lon_lat[1]) <= 90)) {
    throw UsageError(std::string(option) + ": the latitude " + format_number(lon_lat[1]) +
                     " is outside [-90, 90]; the longitude comes first");
  }
  return {lon_lat[0], lon_lat[1]};
}

// A line, its verdict and its figures, as `prepare` finds them.
struct Judged {
  Mission mission;
  std::vector<TileScores> scores;
  Selection selection;
  QualityStatus status = QualityStatus::kBad;
  std::string text;
};

void judge(Judged& line) {
  ReportInput input;
  input.mission = line.mission;
  input.scores = line.scores;
  input.selection = line.selection;
  const std::vector<QualityRow> rows = quality_rows(input);
  line.status = verdict_of(rows);
  line.text = verdict_sentence(line.status, rows, line.selection);
}

double p_or_zero(const Selection& selection) {
  return selection.probability ? selection.probability->p_within_limit : 0;
}

// Is a a better line than b, whatever they cost?
bool is_safer(const Judged& a, const Judged& b) {
  if (a.status != b.status) return a.status < b.status;
  if (p_or_zero(a.selection) != p_or_zero(b.selection)) return p_or_zero(a.selection) > p_or_zero(b.selection);
  return largest_error_m(a.selection) < largest_error_m(b.selection);
}

RerouteLine figures_of(const Judged& line, const NoFlyZones& zones) {
  RerouteLine figures;
  figures.verdict = line.status;
  figures.verdict_text = line.text;
  if (line.selection.probability) figures.p_within_limit = line.selection.probability->p_within_limit;
  figures.largest_error_m = largest_error_m(line.selection);
  figures.matchable_fraction = line.selection.matchable_fraction;
  const std::vector<FlightSample>& samples = line.mission.flight.samples;
  figures.length_m = route_length_m(line.mission.flight.route);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    figures.duration_s += (samples[i].distance_m - samples[i - 1].distance_m) / samples[i - 1].speed_mps;
  }
  const Route& route = line.mission.flight.route;
  for (std::size_t i = 0; i < route.legs.size(); ++i) {
    const GeodeticPoint from = route.vertices[static_cast<std::size_t>(route.legs[i].from)].point;
    const GeodeticPoint to = route.vertices[static_cast<std::size_t>(route.legs[i].to)].point;
    if (i == 0) figures.points.push_back(from);
    figures.points.push_back(to);
    if (i == 0) continue;
    const GeodeticPoint before = route.vertices[static_cast<std::size_t>(route.legs[i - 1].from)].point;
    const double turned_deg = std::abs(std::remainder(
        geodesic_between(from, to).start_azimuth_deg - geodesic_between(before, from).end_azimuth_deg, 360.0));
    figures.turned_deg += turned_deg;
    if (turned_deg > kTurn_deg) ++figures.turns;
  }
  figures.no_fly_m = forbidden_way(zones, samples).length_m;
  return figures;
}

// The planned line as a QGroundControl plan that can be edited.
struct BasePlan {
  std::string name;
  Json json;
  Route route;  ///< Of the JSON: its vertices name the items.
};

// Options that are for vector files only do not go with a plan.
TileOptions for_plan(TileOptions options, const fs::path& route) {
  options.route = route.string();
  options.route_options.height_reference = HeightReference::kAuto;
  options.route_options.layer.clear();
  options.route_options.feature.clear();
  return options;
}

Route straight_route(const LineOptions& line, const RouteOptions& options) {
  if (!options.agl_m || !options.speed_mps) {
    throw UsageError("from and to say neither height nor speed; give --agl-m and --speed-mps");
  }
  Route route;
  route.name = "from and to";
  for (const auto& [numbers, name] : {std::pair(&line.from, "from"), std::pair(&line.to, "to")}) {
    RouteVertex vertex;
    vertex.point = point_of(*numbers, name);
    vertex.agl_m = *options.agl_m;
    vertex.speed_mps = *options.speed_mps;
    vertex.kind = "waypoint";
    route.vertices.push_back(vertex);
  }
  const double length_m = geodesic_between(route.vertices[0].point, route.vertices[1].point).length_m;
  if (length_m < kOnePlace_m) throw DataError("from and to are one place, " + place_text(route.vertices[0].point));
  route.legs.push_back({0, 1, length_m});
  return route;
}

BasePlan base_plan(const TileOptions& options, const Route& route, std::vector<std::string>& notes) {
  BasePlan base;
  base.name = route.name;
  if (route.format == "QGroundControl plan") {
    base.json = parse_json(route.name, read_file(options.route, kMaxRouteBytes));
    base.route = route;
  } else {
    base.json = plan_of_route(route);
    base.route = parse_qgc_plan(route.name, base.json, for_plan(options, "").route_options);
    for (const RouteItem& item : route.items) {
      if (item.became.starts_with("left out")) {
        notes.push_back("item " + std::to_string(item.index) + " (" + item.what + ") of " + route.name +
                        " is not in the new plan: " + item.became.substr(std::string("left out: ").size()));
      }
    }
  }
  require_one_line(base.route);
  return base;
}

// Which legs stay as they are.
std::vector<bool> kept_legs(const LineOptions& options, const Route& route) {
  std::vector<bool> kept(route.legs.size(), false);
  for (const double number : options.keep) {
    if (number != std::floor(number) || number < 1 || number > static_cast<double>(kept.size())) {
      throw UsageError("keep = " + format_number(number) + " is no leg of the route, which has legs 1 to " +
                       std::to_string(kept.size()));
    }
    kept[static_cast<std::size_t>(number) - 1] = true;
  }
  const auto goes_on_by_itself = [](const RouteVertex& from, const RouteVertex& to) {
    if (to.kind == "takeoff" || to.kind == "VTOL takeoff") return true;
    return from.source_item >= 0 && from.source_item == to.source_item && to.kind != "spline waypoint";
  };
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const RouteVertex& from = route.vertices[static_cast<std::size_t>(route.legs[i].from)];
    const RouteVertex& to = route.vertices[static_cast<std::size_t>(route.legs[i].to)];
    if (goes_on_by_itself(from, to)) kept[i] = true;
  }
  if (std::find(kept.begin(), kept.end(), false) == kept.end()) {
    throw UsageError("every leg of " + route.name +
                     " is to be kept (keep, or a takeoff, survey, circle or landing "
                     "pattern); there is nothing that may move");
  }
  return kept;
}

// Legs [first, last] that are flown otherwise.
struct MovableRun {
  std::size_t first = 0;
  std::size_t last = 0;
};

std::vector<MovableRun> movable_runs(const std::vector<bool>& kept, bool keep_waypoints) {
  std::vector<MovableRun> runs;
  for (std::size_t leg = 0; leg < kept.size(); ++leg) {
    if (kept[leg]) continue;
    const bool goes_on = !runs.empty() && runs.back().last + 1 == leg && !keep_waypoints;
    if (goes_on) {
      runs.back().last = leg;
    } else {
      runs.push_back({leg, leg});
    }
  }
  return runs;
}

NoFlyZones read_zones(const BasePlan& base, const LineOptions& options) {
  NoFlyZones zones;
  zones.margin_m = options.avoid_margin_m;
  const QgcGeofence fence = parse_qgc_geofence(base.name, base.json);
  zones.inside_any = fence.inside_any;
  const std::string source = "the geofence of " + base.name;
  for (const GeodeticArea& area : fence.excluded) zones.zones.push_back({area, source, false});
  for (const GeodeticArea& area : fence.included) zones.zones.push_back({area, source, true});
  for (const std::string& file : options.avoid) {
    for (const GeodeticArea& area : read_areas(file)) zones.zones.push_back({area, name_as_utf8(file), false});
  }
  return zones;
}

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
  const double few_m = (std::sqrt(length_m * length_m + 3.14159 * area_m2) - length_m) / 3.14159;
  return std::max({std::min(length_m / 4, few_m), 4 * stride_m, mission.flight.corridor_half_width_m});
}

// Everything that the tries of one run have in common.
class LineFinder {
 public:
  LineFinder(const RerouteOptions& options, const BasePlan& base, Mission area, std::vector<TileScores> scores,
             const NoFlyZones& zones, double corridor_half_width_m, int threads, const Progress& progress)
      : options_(options),
        base_(base),
        area_(std::move(area)),
        scores_(std::move(scores)),
        zones_(zones, area_.ground.crs),
        transform_(area_.ground.crs),
        threads_(threads),
        progress_(progress) {
    open_terrain();
    for (const TileScores& score : scores_) {
      const bool counts = is_matchable(score, options.mission.select);
      p_of_tile_.push_back(!counts ? 0 : std::isnan(score.p_correct_fix) ? 1 : score.p_correct_fix);
    }
    select_ = options.mission.select;
    select_.budget.reset();  // the corridor of the new line has fewer tiles than the ground that is searched
    select_.sparse = false;
    select_.advise = false;
    trial_ = area_;
    trial_.flight.corridor_half_width_m = corridor_half_width_m;
    const std::vector<bool> kept = kept_legs(options.line, base.route);
    runs_ = movable_runs(kept, options.line.keep_waypoints);
    find_legs();
    place_anchors();
    keep_ways();
    make_model();
  }

  const std::vector<MovableRun>& runs() const { return runs_; }

  void search_ground() {
    ground_ = std::make_unique<SearchGround>(area_, p_of_tile_, zones_, options_.line.keep_within_m.value_or(INFINITY),
                                             anchors_m_);
    graph_ = ground_->graph(threads_);
  }

  // The cheapest line on which this share of the flights stays within the limit, by the search's model.
  std::optional<LinePoints> find(double min_share, bool good_reach) {
    const LineDemand demand{min_share, good_reach, options_.line.turn_cost_m};
    std::vector<SearchStretch> stretches;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      stretches.push_back({ground_->anchor_place(2 * i), ground_->anchor_place(2 * i + 1)});
    }
    const auto found = search_line(graph_, model_, kept_, stretches, demand, {}, progress_);
    if (!found) return std::nullopt;
    LinePoints points;
    for (const auto& places : found->places) {
      auto& stretch = points.emplace_back();
      for (const std::uint32_t place : places) stretch.push_back(graph_.places_m[place]);
    }
    return straighten_line(*ground_, model_, kept_, std::move(points), demand, threads_);
  }

  double cost_m(const LinePoints& points) const {
    return line_worth(*ground_, model_, kept_, points, {0, false, options_.line.turn_cost_m}).cost_m;
  }

  MovedPlan plan_of(const LinePoints& points) const {
    std::vector<MovedStretch> stretches;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      MovedStretch stretch{base_.route.legs[runs_[i].first].from, base_.route.legs[runs_[i].last].to,
                           waypoints_of(runs_[i], points[i])};
      stretches.push_back(std::move(stretch));
    }
    return move_stretches(base_.name, base_.json, base_.route, stretches);
  }

  // What the selection predicts of a plan, from the scores of the ground that was searched.
  Judged predict(const MovedPlan& plan) {
    const TileOptions tile = for_plan(options_.mission.tile, "");
    Route route = parse_qgc_plan(base_.name, plan.json, tile.route_options);
    const std::vector<RouteSample> samples = sample_route(route, kSampleStep_m, terrain_);
    trial_.flight.samples.clear();
    for (const RouteSample& sample : samples) {
      FlightSample placed{sample};
      placed.point_map_m = map_of(sample.point);
      placed.level = level_at(sample.agl_m);
      trial_.flight.samples.push_back(placed);
    }
    trial_.flight.route = std::move(route);
    Judged line;
    line.selection = select_tiles(trial_, scores_, stored_size(options_.mission.build, trial_.ground), select_);
    line.mission.flight = trial_.flight;
    line.mission.ground = trial_.ground;
    line.scores = scores_;
    judge(line);
    return line;
  }

  std::vector<SearchedTile> searched() const {
    std::vector<SearchedTile> tiles;
    for (std::size_t i = 0; i < area_.ground.tiles.size(); ++i) {
      const GroundTile& tile = area_.ground.tiles[i];
      if (tile.level != 0 || !(tile.valid_fraction >= 0.5)) continue;
      const double half_m = area_.ground.levels[0].matrix.stride_px * area_.ground.levels[0].gsd_m / 2;
      const Eigen::Vector2d c = tile.bounds.center_m();
      SearchedTile cell{p_of_tile_[i], {}};
      for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
        const auto corner = transform_.geodetic_from_map(c + half_m * Eigen::Vector2d(x, y));
        if (corner) cell.corners.push_back(*corner);
      }
      if (cell.corners.size() == 4) tiles.push_back(std::move(cell));
    }
    return tiles;
  }

 private:
  void open_terrain() {
    if (area_.flight.flat_ground_amsl_m) {
      terrain_ = [amsl_m = *area_.flight.flat_ground_amsl_m](GeodeticPoint) { return amsl_m; };
    } else if (!area_.ground.elevation.empty()) {
      const auto model = std::make_shared<const Elevation>(area_.ground.elevation);
      terrain_ = [model](GeodeticPoint point) { return model->amsl_m(point); };
    }
  }

  Eigen::Vector2d map_of(GeodeticPoint point) const {
    const auto placed = transform_.map_from_geodetic(point);
    if (!placed) throw DataError(place_text(point) + " has no place on the mission grid");
    return *placed;
  }

  GeodeticPoint geodetic_of(const Eigen::Vector2d& point_m) const {
    const auto point = transform_.geodetic_from_map(point_m);
    if (!point) throw DataError("a point of the mission grid has no longitude and latitude");
    return *point;
  }

  int level_at(double agl_m) const {
    if (!(agl_m >= area_.flight.min_agl_m)) return FlightSample::kNoLevel;
    for (const GridLevel& level : area_.ground.levels) {
      if (agl_m <= level.max_agl_m) return level.matrix.level;
    }
    return area_.ground.levels.back().matrix.level;
  }

  // The samples of each leg of the planned line, [begin, end).
  void find_legs() {
    const std::vector<FlightSample>& samples = area_.flight.samples;
    legs_.resize(base_.route.legs.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      auto& [begin, end] = legs_.at(static_cast<std::size_t>(samples[i].leg));
      if (end == 0) begin = i;
      end = i + 1;
    }
  }

  void place_anchors() {
    const auto refuse = [&](const FlightSample& sample, const std::string& what) {
      const std::string source = zones_.forbidden_by(sample.point_map_m);
      if (!source.empty()) {
        throw DataError(what + ", " + place_text(sample.point) + ", lies in a no-fly zone or outside the fence (" +
                        source + "; avoid_margin_m = " + format_number(options_.line.avoid_margin_m) + ")");
      }
      if (!has_imagery(sample.point_map_m)) {
        throw DataError(what + ", " + place_text(sample.point) + ", lies outside the imagery; no line can be planned");
      }
    };
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const FlightSample& from = area_.flight.samples[legs_[runs_[i].first].first];
      const FlightSample& to = area_.flight.samples[legs_[runs_[i].last].second - 1];
      const std::string which = runs_.size() == 1 ? "the" : "moved stretch " + std::to_string(i + 1) + ": its";
      refuse(from, which + " start");
      refuse(to, which + " end");
      if ((to.point_map_m - from.point_map_m).norm() < kOnePlace_m) {
        throw DataError("legs " + std::to_string(runs_[i].first + 1) + " to " + std::to_string(runs_[i].last + 1) +
                        " of " + base_.name +
                        " lead back to where they begin, so that the cheapest line is none; "
                        "keep every waypoint (--keep-waypoints), or some legs (--keep)");
      }
      anchors_m_.push_back(from.point_map_m);
      anchors_m_.push_back(to.point_map_m);
    }
  }

  bool has_imagery(const Eigen::Vector2d& point_m) const {
    return std::any_of(area_.ground.tiles.begin(), area_.ground.tiles.end(), [&](const GroundTile& tile) {
      return tile.valid_fraction >= 0.5 && tile.bounds.contains(point_m);
    });
  }

  std::vector<FlownStep> steps_of_leg(std::size_t leg) const {
    std::vector<FlownStep> steps;
    const auto [begin, end] = legs_[leg];
    for (std::size_t i = begin; i + 1 < end; ++i) {
      const FlightSample& from = area_.flight.samples[i];
      const auto tile = tile_under(area_, from);
      steps.push_back({static_cast<float>(area_.flight.samples[i + 1].distance_m - from.distance_m),
                       static_cast<float>(tile ? p_of_tile_[*tile] : 0)});
    }
    return steps;
  }

  // The legs before, between and behind the runs.
  void keep_ways() {
    std::size_t next_leg = 0;
    for (std::size_t i = 0; i <= runs_.size(); ++i) {
      const std::size_t end_leg = i < runs_.size() ? runs_[i].first : legs_.size();
      KeptWay way;
      for (std::size_t leg = next_leg; leg < end_leg; ++leg) {
        const auto [begin, end] = legs_[leg];
        const Eigen::Vector2d& a_m = area_.flight.samples[begin].point_map_m;
        const Eigen::Vector2d& b_m = area_.flight.samples[end - 1].point_map_m;
        refuse_forbidden(leg);
        const double rad = heading_rad(a_m, b_m);
        if (leg == next_leg) {
          way.first_heading_rad = rad;
        } else {
          way.turn_rad += std::abs(std::remainder(rad - way.last_heading_rad, 2 * 3.14159265358979));
        }
        way.last_heading_rad = rad;
        for (const FlownStep& step : steps_of_leg(leg)) {
          way.steps.push_back(step);
          way.length_m += step.length_m;
        }
      }
      kept_.push_back(std::move(way));
      next_leg = i < runs_.size() ? runs_[i].last + 1 : next_leg;
    }
  }

  void refuse_forbidden(std::size_t leg) const {
    const auto [begin, end] = legs_[leg];
    for (std::size_t i = begin; i + 1 < end; ++i) {
      const Eigen::Vector2d& a_m = area_.flight.samples[i].point_map_m;
      const Eigen::Vector2d& b_m = area_.flight.samples[i + 1].point_map_m;
      if (zones_.clear(a_m, b_m)) continue;
      const std::string source = zones_.forbidden_by(a_m);
      throw DataError("leg " + std::to_string(leg + 1) + " of " + base_.name +
                      " stays as it is, and leads through a no-fly zone or out of the fence" +
                      (source.empty() ? "" : " (" + source + ")"));
    }
  }

  void make_model() {
    const std::vector<FlightSample>& samples = area_.flight.samples;
    double duration_s = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      duration_s += (samples[i].distance_m - samples[i - 1].distance_m) / samples[i - 1].speed_mps;
    }
    const double speed_mps = samples.back().distance_m / duration_s;
    const GridLevel& level = area_.ground.levels.front();
    const double stride_m = level.matrix.stride_px * level.gsd_m;
    const double window_m =
        std::max({options_.mission.select.fix_decorrelation_m.value_or(level.matrix.tile_size_px * level.gsd_m),
                  options_.mission.select.fix_interval_s * speed_mps, 1.0});
    model_ = make_fix_age_model(make_ins_error_model(area_.flight.ins), speed_mps, area_.flight.max_error_m,
                                QualityThresholds::kErrorShareGood, window_m, stride_m / 2);
  }

  // Heights of the planned line at a share of a run's length.
  struct PlannedHeight {
    double amsl_m = kNaN;
    double agl_m = kNaN;
  };
  PlannedHeight planned_height(const MovableRun& run, double share) const {
    const std::size_t begin = legs_[run.first].first;
    const std::size_t end = legs_[run.last].second;
    const std::vector<FlightSample>& samples = area_.flight.samples;
    const double at_m = samples[begin].distance_m + share * (samples[end - 1].distance_m - samples[begin].distance_m);
    std::size_t i = begin;
    while (i + 1 < end && samples[i + 1].distance_m < at_m) ++i;
    if (i + 1 == end) return {samples[i].amsl_m, samples[i].agl_m};
    const double way_m = samples[i + 1].distance_m - samples[i].distance_m;
    const double part = way_m > 0 ? (at_m - samples[i].distance_m) / way_m : 0;
    return {samples[i].amsl_m + part * (samples[i + 1].amsl_m - samples[i].amsl_m),
            samples[i].agl_m + part * (samples[i + 1].agl_m - samples[i].agl_m)};
  }

  PlanWaypoint waypoint_at(const MovableRun& run, const Eigen::Vector2d& point_m, double share) const {
    PlanWaypoint waypoint;
    waypoint.point = geodetic_of(point_m);
    waypoint.share = share;
    const PlannedHeight planned = planned_height(run, share);
    waypoint.agl_m = planned.agl_m;
    const double ground_m = terrain_ ? terrain_(waypoint.point) : kNaN;
    waypoint.amsl_m = std::isfinite(ground_m + planned.agl_m) ? ground_m + planned.agl_m : planned.amsl_m;
    return waypoint;
  }

  // The inner points of a stretch as waypoints as high above the ground as the planned line is at the same share of its
  // length, and more of them where a straight leg between two would come too near to the ground.
  std::vector<PlanWaypoint> waypoints_of(const MovableRun& run, std::vector<Eigen::Vector2d> points) const {
    std::vector<double> along_m = {0};
    for (std::size_t i = 1; i < points.size(); ++i) {
      along_m.push_back(along_m.back() + (points[i] - points[i - 1]).norm());
    }
    const double all_m = std::max(along_m.back(), 1e-9);
    for (int added = 0; terrain_ && added < kMostHeightPoints; ++added) {
      double worst = kLowestShareOfAgl;
      std::size_t worst_leg = 0;
      double worst_part = 0;
      for (std::size_t i = 1; i < points.size(); ++i) {
        const double a_m = waypoint_at(run, points[i - 1], along_m[i - 1] / all_m).amsl_m;
        const double b_m = waypoint_at(run, points[i], along_m[i] / all_m).amsl_m;
        const int parts = static_cast<int>(std::ceil((along_m[i] - along_m[i - 1]) / ground_->step_m()));
        for (int k = 1; k < parts; ++k) {
          const double part = static_cast<double>(k) / parts;
          const double share = (along_m[i - 1] + part * (along_m[i] - along_m[i - 1])) / all_m;
          const double wanted_m = planned_height(run, share).agl_m;
          const double ground_m = terrain_(geodetic_of(points[i - 1] + part * (points[i] - points[i - 1])));
          const double flown = (a_m + part * (b_m - a_m) - ground_m) / wanted_m;
          if (!(flown < worst)) continue;
          worst = flown;
          worst_leg = i;
          worst_part = part;
        }
      }
      if (worst_leg == 0) break;
      const auto at = static_cast<std::ptrdiff_t>(worst_leg);
      points.insert(points.begin() + at,
                    points[worst_leg - 1] + worst_part * (points[worst_leg] - points[worst_leg - 1]));
      along_m.insert(along_m.begin() + at,
                     along_m[worst_leg - 1] + worst_part * (along_m[worst_leg] - along_m[worst_leg - 1]));
    }
    std::vector<PlanWaypoint> waypoints;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      waypoints.push_back(waypoint_at(run, points[i], along_m[i] / all_m));
    }
    return waypoints;
  }

  const RerouteOptions& options_;
  const BasePlan& base_;
  Mission area_;
  std::vector<TileScores> scores_;
  ZonesOnGrid zones_;
  CrsTransform transform_;
  int threads_;
  const Progress& progress_;
  TerrainHeight terrain_;
  std::vector<double> p_of_tile_;
  SelectOptions select_;
  Mission trial_;
  std::vector<std::pair<std::size_t, std::size_t>> legs_;
  std::vector<MovableRun> runs_;
  std::vector<Eigen::Vector2d> anchors_m_;  ///< First and last point of each run.
  std::vector<KeptWay> kept_;
  FixAgeModel model_;
  std::unique_ptr<SearchGround> ground_;
  LineGraph graph_;
};

// A line that was found, and what the selection predicts of it.
struct Candidate {
  LinePoints points;
  MovedPlan plan;
  double cost_m = 0;
  Judged predicted;
};

// The lines worth a look: the cheapest of all, then ones that more of the flights survive by the search's model, by
// bisection, until the cheapest that the selection calls GO is found.
std::vector<Candidate> try_lines(LineFinder& finder, double asked, const Progress& progress) {
  std::vector<Candidate> tried;
  const auto try_share = [&](double share, bool good_reach) -> const Candidate* {
    report_progress(progress, "searching for a line", 0, 0);
    auto points = finder.find(share, good_reach);
    if (!points) return nullptr;
    MovedPlan plan = finder.plan_of(*points);
    Judged predicted = finder.predict(plan);
    tried.push_back({std::move(*points), std::move(plan), 0, std::move(predicted)});
    tried.back().cost_m = finder.cost_m(tried.back().points);
    return &tried.back();
  };
  const auto is_go = [](const Candidate* line) {
    return line != nullptr && line->predicted.status == QualityStatus::kGood;
  };
  if (is_go(try_share(0, false))) return tried;
  // −log(1 − share): equal steps are equal factors of the flights that are lost.
  double low = 0;
  double high = INFINITY;
  double rigor = -std::log(1 - std::min(asked, 0.999));
  bool any_go = false;
  bool any_good_reach = false;
  for (int i = 0; i < kMostTries && high - low > 0.05; ++i) {
    const Candidate* line = try_share(1 - std::exp(-rigor), true);
    any_good_reach = any_good_reach || line != nullptr;
    any_go = any_go || is_go(line);
    // A line that is not GO asks for a better one; none at all, or one that is GO, for less.
    (line != nullptr && !is_go(line) ? low : high) = rigor;
    rigor = std::isfinite(high) ? (low + high) / 2 : rigor + 1;
  }
  if (any_go) return tried;
  // Nothing is GO: the line that most flights survive, with whatever gaps.
  low = 0;
  high = INFINITY;
  rigor = any_good_reach ? 1 : 0.1;
  for (int i = 0; i < kMostTries && high - low > 0.05; ++i) {
    (try_share(1 - std::exp(-rigor), false) != nullptr ? low : high) = rigor;
    rigor = std::isfinite(high) ? (low + high) / 2 : rigor * 2;
  }
  return tried;
}

Judged verify(const RerouteOptions& options, const fs::path& plan, const RerouteRun& run, const Progress& progress,
              bool allow_uncovered) {
  TileOptions tile = plan.empty() ? options.mission.tile : for_plan(options.mission.tile, plan);
  tile.allow_uncovered = tile.allow_uncovered || allow_uncovered;
  Judged line;
  line.mission = plan_tiles(tile, progress);
  line.scores =
      score_ground(line.mission.ground, score_options_of(options.mission), run.seed, run.threads, progress).scores;
  line.selection = select_tiles(line.mission, line.scores, stored_size(options.mission.build, line.mission.ground),
                                options.mission.select);
  judge(line);
  return line;
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

}  // namespace

std::vector<fs::path> reroute_outputs(const fs::path& output) {
  std::vector<fs::path> files = {output};
  for (const char* ending : {".json", ".geojson", ".html"}) files.push_back(fs::path(output).replace_extension(ending));
  return files;
}

RerouteResult reroute(const RerouteOptions& given, const RerouteRun& run, const Progress& progress) {
  check_line_options(given);
  if (run.output.extension() != ".plan") {
    throw UsageError(name_as_utf8(run.output.string()) + ": the new route is a QGroundControl plan; name it *.plan");
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
    write_file(direct, json_text(plan_of_route(straight_route(options.line, options.mission.tile.route_options)), 4),
               true);
    options.mission.tile = for_plan(options.mission.tile, direct);
  }

  const Route planned = read_route(options.mission.tile.route, options.mission.tile.route_options);
  const BasePlan base = base_plan(options.mission.tile, planned, result.notes);
  kept_legs(options.line, base.route);  // fails now, not after minutes
  const NoFlyZones zones = read_zones(base, options.line);
  const Judged before = verify(options, "", run, progress, true);
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
  Mission area = plan_tiles(around, progress);
  result.tiles = static_cast<std::int64_t>(area.ground.tiles.size());
  std::vector<TileScores> scores =
      score_ground(area.ground, search_scores(score_options_of(options.mission)), run.seed, run.threads, progress)
          .scores;
  LineFinder finder(options, base, std::move(area), std::move(scores), zones,
                    before.mission.flight.corridor_half_width_m, run.threads, progress);
  finder.search_ground();
  for (const MovableRun& moved : finder.runs()) {
    for (std::size_t leg = moved.first; leg <= moved.last; ++leg) result.moved_legs.push_back(static_cast<int>(leg));
  }
  std::vector<Candidate> tried = try_lines(finder, options.mission.select.min_route_probability, progress);
  result.lines_tried = static_cast<int>(tried.size());
  if (tried.empty()) {
    throw DataError("no line leads from the start to the end over imagery and clear of no-fly zones within " +
                    format_fixed(options.line.keep_within_m.value_or(result.search_within_m), 0) +
                    " m of the planned one; look at --search-within-m, --keep-within-m and --avoid");
  }
  // Those predicted GO by cost, then the others, the safest first.
  std::stable_sort(tried.begin(), tried.end(), [](const Candidate& a, const Candidate& b) {
    const bool a_go = a.predicted.status == QualityStatus::kGood;
    const bool b_go = b.predicted.status == QualityStatus::kGood;
    if (a_go != b_go) return a_go;
    return a_go ? a.cost_m < b.cost_m : is_safer(a.predicted, b.predicted);
  });

  std::optional<Judged> after;
  const Candidate* chosen = nullptr;
  const std::string name = run.output.filename().string();
  for (const Candidate& line : tried) {
    const bool go = line.predicted.status == QualityStatus::kGood;
    if (result.lines_verified == kMostVerified || (chosen != nullptr && !go)) break;
    write_file(staging / name, json_text(line.plan.json, 4), true);
    Judged verified = verify(options, staging / name, run, progress, true);
    ++result.lines_verified;
    if (forbidden_way(zones, verified.mission.flight.samples).length_m > 0) continue;
    const bool is_better = !after || is_safer(verified, *after);
    const bool is_go = verified.status == QualityStatus::kGood;
    if (is_better) {
      after = std::move(verified);
      chosen = &line;
    }
    if (is_go) break;
  }
  if (chosen == nullptr) throw DataError("every line that was found leads through a no-fly zone; look at --avoid");
  write_file(staging / name, json_text(chosen->plan.json, 4), true);

  result.found_go = after->status == QualityStatus::kGood;
  result.before = figures_of(before, zones);
  result.after = figures_of(*after, zones);
  result.assumptions = assumptions_line(after->mission.flight, after->selection);
  result.removed_items = chosen->plan.removed;
  result.lost_items = chosen->plan.lost;
  result.shifted_items = chosen->plan.shifted;
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
  write_file(staging / result.files[1], json_text(reroute_to_json(result)), true);
  write_file(staging / result.files[2], json_text(reroute_to_geojson(result)), true);
  write_file(staging / result.files[3], reroute_to_html(result, base.name), true);
  std::vector<std::string> last_the_plan = {result.files[1], result.files[2], result.files[3], result.files[0]};
  staging.publish(last_the_plan, result.files);
  return result;
}

}  // namespace pilotage
