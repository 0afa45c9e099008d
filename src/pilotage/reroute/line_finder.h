#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/reroute/judged_line.h"
#include "pilotage/reroute/line_search.h"
#include "pilotage/reroute/planned_line.h"
#include "pilotage/reroute/search_ground.h"
#include "pilotage/reroute/straighten_line.h"
#include "pilotage/route/qgc_plan_writer.h"
#include "pilotage/route/sample_route.h"

namespace pilotage {

/// A line that was found, and what the selection predicts of it.
struct LineCandidate {
  LinePoints points;
  MovedPlan plan;
  double cost_m = 0;
  JudgedLine predicted;
};

/// Finds lines over scored ground between the ends of what may move of a planned one. Everything that the tries of one
/// run have in common; what it is made of must outlive it.
class LineFinder {
 public:
  /// `area` is the mission of the planned line with all tiles around it, and `scores` are theirs; the new line's
  /// corridor has `corridor_half_width_m`. Throws DataError when an end of what may move lies in a zone or outside the
  /// imagery, when both ends are nearer than a fifth of the way, or when a leg that is kept is not clear of zones.
  LineFinder(const RerouteOptions& options, const PlannedLine& planned, Mission area, std::vector<TileScores> scores,
             const NoFlyZones& zones, double corridor_half_width_m, int threads, const Progress& progress);

  const std::vector<MovableRun>& runs() const { return runs_; }

  /// The lines worth a look: the cheapest of all, then ones that more of the flights survive by the search's model, by
  /// bisection, until the cheapest that the selection calls GO is found, and that one tightened; where there is none,
  /// those that most flights survive. Empty when no line leads from the one end to the other.
  std::vector<LineCandidate> find_lines();

  /// The tiles of the first level, for the map.
  std::vector<SearchedTile> searched() const;

 private:
  /// Heights of the planned line.
  struct PlannedHeight {
    double amsl_m = 0;
    double agl_m = 0;
  };

  void open_terrain();
  void find_legs();
  void place_anchors();
  void keep_ways();
  void make_model();
  Eigen::Vector2d map_of(GeodeticPoint point) const;
  GeodeticPoint geodetic_of(const Eigen::Vector2d& point_m) const;
  int level_at(double agl_m) const;
  bool has_imagery(const Eigen::Vector2d& point_m) const;
  void refuse_bad_end(const FlightSample& sample, const std::string& what) const;
  void refuse_forbidden_leg(std::size_t leg) const;
  std::vector<FlownStep> steps_of_leg(std::size_t leg) const;
  PlannedHeight planned_height(const MovableRun& run, double share) const;
  PlanWaypoint waypoint_at(const MovableRun& run, const Eigen::Vector2d& point_m, double share) const;
  std::vector<PlanWaypoint> waypoints_of(const MovableRun& run, std::vector<Eigen::Vector2d> points) const;
  std::optional<LinePoints> find(double min_share, bool good_reach);
  const LineCandidate* try_share(double min_share, bool good_reach, std::vector<LineCandidate>& tried);
  double cost_m(const LinePoints& points) const;
  LineCandidate candidate(LinePoints points);
  /// The line with waypoints taken out or brought half way to the straight line between their neighbours, as long as it
  /// becomes cheaper and is predicted GO, with some reserve.
  LineCandidate tightened(LineCandidate line);
  MovedPlan plan_of(const LinePoints& points) const;
  JudgedLine predict(const MovedPlan& plan);

  const RerouteOptions& options_;
  const PlannedLine& planned_;
  Mission area_;
  std::vector<TileScores> scores_;
  ZonesOnGrid zones_;
  CrsTransform transform_;
  int threads_;
  const Progress& progress_;
  TerrainHeight terrain_;
  std::vector<double> p_of_tile_;
  SelectOptions select_;
  Mission trial_;                                          ///< The ground of the area under the line that is looked at.
  std::vector<std::pair<std::size_t, std::size_t>> legs_;  ///< The samples of each planned leg, [begin, end).
  std::vector<MovableRun> runs_;
  std::vector<Eigen::Vector2d> anchors_m_;  ///< First and last point of each run.
  std::vector<KeptWay> kept_;
  FixAgeModel model_;
  std::unique_ptr<SearchGround> ground_;
  LineGraph graph_;
};

}  // namespace pilotage
