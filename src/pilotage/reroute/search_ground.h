#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pilotage/mission/mission.h"
#include "pilotage/reroute/fix_age.h"
#include "pilotage/reroute/line_search.h"
#include "pilotage/reroute/no_fly_zones.h"

namespace pilotage {

/// The ground around a planned line, as the search sees it: where one may fly, and what P a try has there. What it is
/// made of must outlive it.
class SearchGround {
 public:
  /// `area` is the mission of the planned line with all tiles around it; `p_of_tile` is 0 for those that no fix is
  /// counted on. Places are the centres of tiles of the level that most of the line is flown over, where at least half
  /// of the tile is imagery, at most `within_m` (which may be infinite) from the planned line. The points of `anchors`
  /// may be flown over whatever lies there.
  SearchGround(const Mission& area, const std::vector<double>& p_of_tile, const ZonesOnGrid& zones, double within_m,
               std::vector<Eigen::Vector2d> anchors_m);

  double stride_m() const { return stride_m_; }
  double step_m() const { return stride_m_ / 2; }
  std::size_t place_count() const { return places_.size(); }

  /// Moves between neighbours in 16 directions, and from and to anchors nearer than the longest of those. Places of
  /// the graph are the tiles', then the anchors in their order. The same for any number of threads.
  LineGraph graph(int threads) const;
  std::uint32_t anchor_place(std::size_t anchor) const { return static_cast<std::uint32_t>(places_.size() + anchor); }

  /// Whether one may fly straight from a to b: over imagery, near enough to the planned line, clear of zones.
  bool clear(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

  /// What lies under the straight line from a to b, in steps of at most step_m().
  std::vector<FlownStep> steps_between(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

 private:
  struct Place {
    std::int64_t column = 0;
    std::int64_t row = 0;
    Eigen::Vector2d center_m;
  };

  std::ptrdiff_t place_at(std::int64_t column, std::int64_t row) const;
  bool may_be_flown_over(const Eigen::Vector2d& point_m) const;
  double p_at(const Eigen::Vector2d& point_m) const;

  const Mission& area_;
  const std::vector<double>& p_of_tile_;
  const ZonesOnGrid& zones_;
  double within_m_;
  std::vector<Eigen::Vector2d> anchors_m_;
  int level_ = 0;
  bool one_level_ = true;
  double stride_m_ = 0;
  std::vector<Place> places_;  ///< Ascending by row, then column.
};

/// Clockwise from the grid's north.
double heading_rad(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);

}  // namespace pilotage
