#include "pilotage/reroute/line_finder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/mission/flight_time.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/route/qgc_plan.h"
#include "pilotage/select/select_tiles.h"

namespace pilotage {
namespace {

constexpr double kSampleStep_m = 10;  // as plan_tiles
constexpr double kLeastImagery = 0.5;
constexpr double kLowestShareOfAgl = 0.8;  // of the planned height above ground, before a waypoint is put in
constexpr int kMostHeightPoints = 32;
constexpr double kFewestFixes = 3;  // that the model of the search takes a flight to have had
constexpr double kMostFixes = 40;
constexpr int kMostTries = 9;
constexpr int kMostLooks = 60;        // at lines, while one is tightened
constexpr double kLeastSaving_m = 1;  // that is worth a look
constexpr double kReserve = 0.15;     // of what is left to certainty, for the tiles of the new line's own grid

std::string place_text(GeodeticPoint point) {
  return "lon " + format_fixed(point.lon_deg, 6) + ", lat " + format_fixed(point.lat_deg, 6);
}

}  // namespace

LineFinder::LineFinder(const RerouteOptions& options, const PlannedLine& planned, Mission area,
                       std::vector<TileScores> scores, const NoFlyZones& zones, double corridor_half_width_m,
                       int threads, const Progress& progress)
    : options_(options),
      planned_(planned),
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
  runs_ = movable_runs(planned.kept, options.line.keep_waypoints);
  find_legs();
  place_anchors();
  keep_ways();
  make_model();
  ground_ = std::make_unique<SearchGround>(area_, p_of_tile_, zones_, options.line.keep_within_m.value_or(INFINITY),
                                           anchors_m_);
  graph_ = ground_->graph(threads);
}

void LineFinder::open_terrain() {
  if (area_.flight.flat_ground_amsl_m) {
    terrain_ = [amsl_m = *area_.flight.flat_ground_amsl_m](GeodeticPoint) { return amsl_m; };
  } else if (!area_.ground.elevation.empty()) {
    const auto model = std::make_shared<const Elevation>(area_.ground.elevation);
    terrain_ = [model](GeodeticPoint point) { return model->amsl_m(point); };
  }
}

Eigen::Vector2d LineFinder::map_of(GeodeticPoint point) const {
  const auto placed = transform_.map_from_geodetic(point);
  if (!placed) throw DataError(place_text(point) + " has no place on the mission grid");
  return *placed;
}

GeodeticPoint LineFinder::geodetic_of(const Eigen::Vector2d& point_m) const {
  const auto point = transform_.geodetic_from_map(point_m);
  if (!point) throw DataError("a point of the mission grid has no longitude and latitude");
  return *point;
}

int LineFinder::level_at(double agl_m) const {
  if (!(agl_m >= area_.flight.min_agl_m)) return FlightSample::kNoLevel;
  for (const GridLevel& level : area_.ground.levels) {
    if (agl_m <= level.max_agl_m) return level.matrix.level;
  }
  return area_.ground.levels.back().matrix.level;
}

void LineFinder::find_legs() {
  const std::vector<FlightSample>& samples = area_.flight.samples;
  legs_.resize(planned_.route.legs.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto& [begin, end] = legs_.at(static_cast<std::size_t>(samples[i].leg));
    if (end == 0) begin = i;
    end = i + 1;
  }
}

bool LineFinder::has_imagery(const Eigen::Vector2d& point_m) const {
  return std::any_of(area_.ground.tiles.begin(), area_.ground.tiles.end(), [&](const GroundTile& tile) {
    return tile.valid_fraction >= kLeastImagery && tile.bounds.contains(point_m);
  });
}

void LineFinder::refuse_bad_end(const FlightSample& sample, const std::string& what) const {
  const std::string source = zones_.forbidden_by(sample.point_map_m);
  if (!source.empty()) {
    throw DataError(what + ", " + place_text(sample.point) + ", lies in a no-fly zone or outside the fence (" + source +
                    "; avoid_margin_m = " + format_number(options_.line.avoid_margin_m) + ")");
  }
  if (!has_imagery(sample.point_map_m)) {
    throw DataError(what + ", " + place_text(sample.point) + ", lies outside the imagery; no line can be planned");
  }
}

void LineFinder::place_anchors() {
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const FlightSample& from = area_.flight.samples[legs_[runs_[i].first].first];
    const FlightSample& to = area_.flight.samples[legs_[runs_[i].last].second - 1];
    const std::string which = runs_.size() == 1 ? "the" : "moved stretch " + std::to_string(i + 1) + ": its";
    refuse_bad_end(from, which + " start");
    refuse_bad_end(to, which + " end");
    anchors_m_.push_back(from.point_map_m);
    anchors_m_.push_back(to.point_map_m);
  }
}

std::vector<FlownStep> LineFinder::steps_of_leg(std::size_t leg) const {
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

void LineFinder::refuse_forbidden_leg(std::size_t leg) const {
  const auto [begin, end] = legs_[leg];
  for (std::size_t i = begin; i + 1 < end; ++i) {
    const Eigen::Vector2d& a_m = area_.flight.samples[i].point_map_m;
    const Eigen::Vector2d& b_m = area_.flight.samples[i + 1].point_map_m;
    if (zones_.clear(a_m, b_m)) continue;
    const std::string source = zones_.forbidden_by(a_m);
    throw DataError("leg " + std::to_string(leg + 1) + " of " + planned_.name +
                    " stays as it is, and leads through a no-fly zone or out of the fence" +
                    (source.empty() ? "" : " (" + source + ")"));
  }
}

// The legs before, between and behind the runs.
void LineFinder::keep_ways() {
  std::size_t next_leg = 0;
  for (std::size_t i = 0; i <= runs_.size(); ++i) {
    const std::size_t end_leg = i < runs_.size() ? runs_[i].first : legs_.size();
    KeptWay way;
    for (std::size_t leg = next_leg; leg < end_leg; ++leg) {
      const auto [begin, end] = legs_[leg];
      const Eigen::Vector2d& a_m = area_.flight.samples[begin].point_map_m;
      const Eigen::Vector2d& b_m = area_.flight.samples[end - 1].point_map_m;
      refuse_forbidden_leg(leg);
      const double rad = heading_rad(a_m, b_m);
      if (leg == next_leg) {
        way.first_heading_rad = rad;
      } else {
        way.turn_rad += std::abs(std::remainder(rad - way.last_heading_rad, 2 * std::numbers::pi));
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

void LineFinder::make_model() {
  const std::vector<FlightSample>& samples = area_.flight.samples;
  const double speed_mps = samples.back().distance_m / flight_time_s(samples);
  const GridLevel& level = area_.ground.levels.front();
  const double stride_m = level.matrix.stride_px * level.gsd_m;
  const double window_m =
      std::max({options_.mission.select.fix_decorrelation_m.value_or(level.matrix.tile_size_px * level.gsd_m),
                options_.mission.select.fix_interval_s * speed_mps, 1.0});
  // How far the filter has settled half way: it knows velocity and tilt the better, the more fixes came before.
  const double fixes = std::clamp(samples.back().distance_m / window_m / 2, kFewestFixes, kMostFixes);
  model_ = make_fix_age_model(make_error_model(area_.flight.ins, area_.flight.conditions), speed_mps,
                              area_.flight.max_error_m, QualityThresholds::kErrorShareGood, window_m, stride_m / 2,
                              static_cast<int>(fixes));
}

// At a share of the length of a run.
LineFinder::PlannedHeight LineFinder::planned_height(const MovableRun& run, double share) const {
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

PlanWaypoint LineFinder::waypoint_at(const MovableRun& run, const Eigen::Vector2d& point_m, double share) const {
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
std::vector<PlanWaypoint> LineFinder::waypoints_of(const MovableRun& run, std::vector<Eigen::Vector2d> points) const {
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

// The cheapest line on which this share of the flights stays within the limit, by the search's model.
std::optional<LinePoints> LineFinder::find(double min_share, bool good_reach) {
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

MovedPlan LineFinder::plan_of(const LinePoints& points) const {
  std::vector<MovedStretch> stretches;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    MovedStretch stretch{planned_.route.legs[runs_[i].first].from, planned_.route.legs[runs_[i].last].to,
                         waypoints_of(runs_[i], points[i])};
    stretches.push_back(std::move(stretch));
  }
  return move_stretches(planned_.name, planned_.json, planned_.route, stretches);
}

// What the selection predicts of a plan, from the scores of the ground that was searched.
JudgedLine LineFinder::predict(const MovedPlan& plan) {
  const TileOptions tile = options_for_plan(options_.mission.tile, "");
  Route route = parse_qgc_plan(planned_.name, plan.json, tile.route_options);
  const std::vector<RouteSample> samples = sample_route(route, kSampleStep_m, terrain_);
  trial_.flight.samples.clear();
  for (const RouteSample& sample : samples) {
    FlightSample placed{sample};
    placed.point_map_m = map_of(sample.point);
    placed.level = level_at(sample.agl_m);
    trial_.flight.samples.push_back(placed);
  }
  trial_.flight.route = std::move(route);
  JudgedLine line;
  line.selection = select_tiles(trial_, scores_, stored_size(options_.mission.build, trial_.ground), select_, threads_);
  line.mission.flight = trial_.flight;
  line.mission.ground = trial_.ground;
  line.scores = scores_;
  judge(line);
  return line;
}

std::vector<SearchedTile> LineFinder::searched() const {
  std::vector<SearchedTile> tiles;
  for (std::size_t i = 0; i < area_.ground.tiles.size(); ++i) {
    const GroundTile& tile = area_.ground.tiles[i];
    if (tile.level != 0 || !(tile.valid_fraction >= kLeastImagery)) continue;
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

double LineFinder::cost_m(const LinePoints& points) const {
  return line_worth(*ground_, model_, kept_, points, {0, false, options_.line.turn_cost_m}).cost_m;
}

LineCandidate LineFinder::candidate(LinePoints points) {
  LineCandidate line;
  line.cost_m = cost_m(points);
  line.plan = plan_of(points);
  line.predicted = predict(line.plan);
  line.points = std::move(points);
  return line;
}

const LineCandidate* LineFinder::try_share(double min_share, bool good_reach, std::vector<LineCandidate>& tried) {
  report_progress(progress_, "searching for a line", 0, 0);
  auto points = find(min_share, good_reach);
  if (!points) return nullptr;
  tried.push_back(candidate(std::move(*points)));
  return &tried.back();
}

LineCandidate LineFinder::tightened(LineCandidate line) {
  const double asked = options_.mission.select.min_route_probability;
  int looks = kMostLooks;
  const auto try_points = [&](LinePoints points, std::size_t stretch, std::size_t k) {
    const std::vector<Eigen::Vector2d>& now = points[stretch];
    for (std::size_t i = k; i < std::min(k + 2, now.size()); ++i) {
      if (!ground_->clear(now[i - 1], now[i])) return false;
    }
    if (!(cost_m(points) < line.cost_m - kLeastSaving_m)) return false;
    --looks;
    report_progress(progress_, "searching for a line", 0, 0);
    LineCandidate next = candidate(std::move(points));
    const bool with_reserve = next.predicted.status == QualityStatus::kGood &&
                              (!next.predicted.selection.probability ||
                               next.predicted.selection.probability->p_within_limit >= asked + kReserve * (1 - asked));
    if (with_reserve) line = std::move(next);
    return with_reserve;
  };
  for (bool shorter = true; shorter;) {
    shorter = false;
    for (std::size_t stretch = 0; stretch < line.points.size(); ++stretch) {
      for (std::size_t k = 1; k + 1 < line.points[stretch].size() && looks > 0;) {
        LinePoints without = line.points;
        without[stretch].erase(without[stretch].begin() + static_cast<std::ptrdiff_t>(k));
        LinePoints nearer = line.points;
        nearer[stretch][k] = nearer[stretch][k] / 2 + (nearer[stretch][k - 1] + nearer[stretch][k + 1]) / 4;
        const bool gone = try_points(std::move(without), stretch, k);
        const bool moved = !gone && looks > 0 && try_points(std::move(nearer), stretch, k);
        shorter = shorter || gone || moved;
        if (!gone) ++k;
      }
    }
  }
  return line;
}

std::vector<LineCandidate> LineFinder::find_lines() {
  std::vector<LineCandidate> tried;
  const auto is_go = [](const LineCandidate* line) {
    return line != nullptr && line->predicted.status == QualityStatus::kGood;
  };
  const LineCandidate* cheapest = try_share(0, false, tried);
  if (cheapest == nullptr || is_go(cheapest)) return tried;
  // −log(1 − share): equal steps are equal factors of the flights that are lost.
  double low = 0;
  double high = INFINITY;
  double rigor = -std::log(1 - std::min(options_.mission.select.min_route_probability, 0.999));
  bool any_go = false;
  for (int i = 0; i < kMostTries && high - low > 0.05; ++i) {
    const LineCandidate* line = try_share(1 - std::exp(-rigor), true, tried);
    any_go = any_go || is_go(line);
    // A line that is not GO asks for a better one; none at all, or one that is GO, for less.
    (line != nullptr && !is_go(line) ? low : high) = rigor;
    rigor = std::isfinite(high) ? (low + high) / 2 : rigor + 1;
  }
  if (any_go) {
    const LineCandidate* best = nullptr;
    for (const LineCandidate& line : tried) {
      if (is_go(&line) && (best == nullptr || line.cost_m < best->cost_m)) best = &line;
    }
    LineCandidate tight = tightened(*best);
    if (tight.cost_m < best->cost_m) tried.push_back(std::move(tight));
    return tried;
  }
  // Nothing is GO: the line that most flights survive, with whatever gaps. By halves and doubles, because the largest
  // share may be of any order.
  double least = 1e-6;
  high = INFINITY;
  rigor = 0.1;
  for (int i = 0; i < 2 * kMostTries && !(high < 1.1 * least); ++i) {
    (try_share(1 - std::exp(-rigor), false, tried) != nullptr ? least : high) = rigor;
    rigor = std::isfinite(high) ? std::sqrt(least * high) : rigor * 2;
  }
  return tried;
}

}  // namespace pilotage
