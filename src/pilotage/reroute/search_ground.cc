#include "pilotage/reroute/search_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "pilotage/base/parallel.h"
#include "pilotage/mission/tile_under.h"

namespace pilotage {
namespace {

constexpr double kLeastTileImagery = 0.5;
// Columns and rows to the neighbours in 16 directions.
constexpr std::array<std::pair<int, int>, 16> kNeighbours = {{{0, 1},
                                                              {1, 2},
                                                              {1, 1},
                                                              {2, 1},
                                                              {1, 0},
                                                              {2, -1},
                                                              {1, -1},
                                                              {1, -2},
                                                              {0, -1},
                                                              {-1, -2},
                                                              {-1, -1},
                                                              {-2, -1},
                                                              {-1, 0},
                                                              {-2, 1},
                                                              {-1, 1},
                                                              {-1, 2}}};
constexpr double kLongestMove = 2.3;  // strides; a little more than the √5 of the longest above

int most_flown_level(const Mission& area) {
  std::vector<double> flown_m(area.ground.levels.size(), 0.0);
  const std::vector<FlightSample>& samples = area.flight.samples;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].level == FlightSample::kNoLevel) continue;
    flown_m[static_cast<std::size_t>(samples[i].level)] += samples[i].distance_m - samples[i - 1].distance_m;
  }
  return static_cast<int>(std::max_element(flown_m.begin(), flown_m.end()) - flown_m.begin());
}

double distance_to_way_m(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double square = along.squaredNorm();
  const double share = square > 0 ? std::clamp((point - a).dot(along) / square, 0.0, 1.0) : 0;
  return (point - a - share * along).norm();
}

bool near_line(const Mission& area, const Eigen::Vector2d& point_m, double within_m) {
  const std::vector<FlightSample>& samples = area.flight.samples;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (distance_to_way_m(point_m, samples[i - 1].point_map_m, samples[i].point_map_m) <= within_m) return true;
  }
  return false;
}

}  // namespace

double heading_rad(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  return std::atan2(to_m.x() - from_m.x(), to_m.y() - from_m.y());
}

SearchGround::SearchGround(const Mission& area, const std::vector<double>& p_of_tile, const ZonesOnGrid& zones,
                           double within_m, std::vector<Eigen::Vector2d> anchors_m)
    : area_(area),
      p_of_tile_(p_of_tile),
      zones_(zones),
      within_m_(within_m),
      anchors_m_(std::move(anchors_m)),
      level_(most_flown_level(area)) {
  for (const FlightSample& sample : area.flight.samples) one_level_ = one_level_ && sample.level == level_;
  const TileMatrix& matrix = area.ground.levels[static_cast<std::size_t>(level_)].matrix;
  stride_m_ = matrix.stride_px * std::abs(matrix.map_from_pixel.x_per_col);
  for (std::size_t i = 0; i < area.ground.tiles.size(); ++i) {
    const GroundTile& tile = area.ground.tiles[i];
    if (tile.level != level_ || !(tile.valid_fraction >= kLeastTileImagery)) continue;
    if (!(area.flight.places[i].offset_m <= within_m)) continue;
    const Eigen::Vector2d center_m = tile.bounds.center_m();
    if (!zones.forbidden_by(center_m).empty()) continue;
    places_.push_back({tile.column, tile.row, center_m});
  }
}

std::ptrdiff_t SearchGround::place_at(std::int64_t column, std::int64_t row) const {
  const auto at = std::lower_bound(places_.begin(), places_.end(), std::pair(row, column),
                                   [](const Place& place, const std::pair<std::int64_t, std::int64_t>& key) {
                                     return std::pair(place.row, place.column) < key;
                                   });
  return at != places_.end() && at->row == row && at->column == column ? at - places_.begin() : -1;
}

bool SearchGround::may_be_flown_over(const Eigen::Vector2d& point_m) const {
  const TileMatrix& matrix = area_.ground.levels[static_cast<std::size_t>(level_)].matrix;
  const Eigen::Vector2d pixel = matrix.map_from_pixel.pixel_from_map(point_m);
  const double half_px = matrix.tile_size_px / 2.0;
  const auto column = static_cast<std::int64_t>(std::llround((pixel.x() - half_px) / matrix.stride_px));
  const auto row = static_cast<std::int64_t>(std::llround((pixel.y() - half_px) / matrix.stride_px));
  if (place_at(column, row) >= 0) return true;
  // The tile may be there, and only its centre in a zone or too far away; those are looked at for themselves.
  if (matrix.contains(column, row)) {
    const auto tile = find_tile(area_.ground, tile_id_of(area_.ground.levels, level_, column, row));
    if (tile && area_.ground.tiles[*tile].valid_fraction >= kLeastTileImagery) return true;
  }
  return std::any_of(anchors_m_.begin(), anchors_m_.end(),
                     [&](const Eigen::Vector2d& anchor_m) { return (anchor_m - point_m).norm() < stride_m_; });
}

bool SearchGround::clear(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  if (!zones_.clear(a_m, b_m)) return false;
  const int parts = std::max(1, static_cast<int>(std::ceil((b_m - a_m).norm() / step_m())));
  for (int i = 0; i <= parts; ++i) {
    const Eigen::Vector2d point_m = a_m + static_cast<double>(i) / parts * (b_m - a_m);
    if (!may_be_flown_over(point_m)) return false;
    if (std::isfinite(within_m_) && !near_line(area_, point_m, within_m_)) return false;
  }
  return true;
}

double SearchGround::p_at(const Eigen::Vector2d& point_m) const {
  FlightSample sample;
  sample.point_map_m = point_m;
  sample.level = level_;
  if (!one_level_) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const FlightSample& planned : area_.flight.samples) {
      const double square = (planned.point_map_m - point_m).squaredNorm();
      if (square < nearest) std::tie(nearest, sample.level) = std::pair(square, planned.level);
    }
  }
  const auto tile = tile_under(area_, sample);
  return tile ? p_of_tile_[*tile] : 0;
}

std::vector<FlownStep> SearchGround::steps_between(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  const double length_m = (b_m - a_m).norm();
  const int parts = std::max(1, static_cast<int>(std::ceil(length_m / step_m() - 1e-9)));
  std::vector<FlownStep> steps;
  for (int i = 0; i < parts; ++i) {
    const Eigen::Vector2d middle_m = a_m + (i + 0.5) / parts * (b_m - a_m);
    steps.push_back({static_cast<float>(length_m / parts), static_cast<float>(p_at(middle_m))});
  }
  return steps;
}

LineGraph SearchGround::graph(int threads) const {
  LineGraph graph;
  for (const Place& place : places_) graph.places_m.push_back(place.center_m);
  graph.places_m.insert(graph.places_m.end(), anchors_m_.begin(), anchors_m_.end());

  struct Found {
    std::vector<LineMove> moves;
    std::vector<FlownStep> steps;
  };
  std::vector<Found> found(graph.places_m.size());
  const double longest_m = kLongestMove * stride_m_;
  const auto find_moves = [&](std::size_t from) {
    const Eigen::Vector2d& a_m = graph.places_m[from];
    const auto add = [&](std::size_t to) {
      const Eigen::Vector2d& b_m = graph.places_m[to];
      if (!((b_m - a_m).norm() > 0) || !clear(a_m, b_m)) return;
      const std::vector<FlownStep> steps = steps_between(a_m, b_m);
      found[from].moves.push_back({static_cast<std::uint32_t>(to), static_cast<float>((b_m - a_m).norm()),
                                   static_cast<float>(heading_rad(a_m, b_m)),
                                   static_cast<std::uint32_t>(found[from].steps.size()),
                                   static_cast<std::uint32_t>(steps.size())});
      found[from].steps.insert(found[from].steps.end(), steps.begin(), steps.end());
    };
    if (from < places_.size()) {
      for (const auto& [columns, rows] : kNeighbours) {
        const std::ptrdiff_t to = place_at(places_[from].column + columns, places_[from].row + rows);
        if (to >= 0) add(static_cast<std::size_t>(to));
      }
    } else {
      for (std::size_t to = 0; to < places_.size(); ++to) {
        if ((graph.places_m[to] - a_m).norm() <= longest_m) add(to);
      }
    }
    for (std::size_t to = places_.size(); to < graph.places_m.size(); ++to) {
      if (to != from && (graph.places_m[to] - a_m).norm() <= longest_m) add(to);
    }
  };
  parallel_for(found.size(), threads, [&](std::size_t from, int) { find_moves(from); });
  for (const Found& one : found) {
    graph.first_move.push_back(static_cast<std::uint32_t>(graph.moves.size()));
    const auto first_step = static_cast<std::uint32_t>(graph.steps.size());
    for (LineMove move : one.moves) {
      move.first_step += first_step;
      graph.moves.push_back(move);
    }
    graph.steps.insert(graph.steps.end(), one.steps.begin(), one.steps.end());
  }
  graph.first_move.push_back(static_cast<std::uint32_t>(graph.moves.size()));
  return graph;
}

}  // namespace pilotage
