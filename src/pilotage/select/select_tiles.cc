#include "pilotage/select/select_tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mission/tile_lookup.h"
#include "pilotage/select/byte_budget.h"
#include "pilotage/select/route_error.h"

namespace pilotage {
namespace {

double judged_margin(const TileScore& score) {
  return std::isnan(score.degraded.margin) ? score.clean.margin : score.degraded.margin;
}

// Counts what the chosen tiles need, overlap counted once: the ground is cut into squares of one stride.
class StorageCount {
 public:
  StorageCount(const TilePlan& plan, const StoredSize& size) : plan_(plan), size_(size), bytes_(size.bytes_fixed) {}

  double bytes_with(const PlanTile& tile) const {
    return bytes_ + size_.bytes_per_tile + new_cells(tile) * cell_bytes(tile);
  }
  void add(const PlanTile& tile) {
    bytes_ = bytes_with(tile);
    for_each_cell(tile, [&](std::int64_t column, std::int64_t row) { covered_.insert({tile.level, row, column}); });
  }
  double bytes() const { return bytes_; }

 private:
  template <class Visit>
  void for_each_cell(const PlanTile& tile, Visit visit) const {
    const TileMatrix& matrix = matrix_of(tile);
    const int cells = (matrix.tile_size_px + matrix.stride_px - 1) / matrix.stride_px;
    for (int row = 0; row < cells; ++row) {
      for (int column = 0; column < cells; ++column) visit(tile.column + column, tile.row + row);
    }
  }
  double new_cells(const PlanTile& tile) const {
    int count = 0;
    for_each_cell(tile, [&](std::int64_t column, std::int64_t row) {
      if (!covered_.contains({tile.level, row, column})) ++count;
    });
    return count;
  }
  double cell_bytes(const PlanTile& tile) const {
    const double stride_px = matrix_of(tile).stride_px;
    const auto level = static_cast<std::size_t>(tile.level);
    const double chip_bytes = size_.chip_bytes_per_px.empty() ? 0 : size_.chip_bytes_per_px.at(level);
    return stride_px * stride_px * (size_.bytes_per_px + chip_bytes);
  }
  const TileMatrix& matrix_of(const PlanTile& tile) const {
    return plan_.levels[static_cast<std::size_t>(tile.level)].matrix;
  }

  const TilePlan& plan_;
  const StoredSize& size_;
  double bytes_ = 0;
  std::set<std::tuple<int, std::int64_t, std::int64_t>> covered_;  // level, row, column
};

// The scores in the order of the plan's tiles.
std::vector<TileScore> scores_of_plan(const TilePlan& plan, const std::vector<TileScore>& scores) {
  std::vector<TileScore> ordered = scores;
  std::sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.tile_id < b.tile_id; });
  const bool same =
      std::equal(plan.tiles.begin(), plan.tiles.end(), ordered.begin(), ordered.end(),
                 [](const PlanTile& tile, const TileScore& score) { return tile.tile_id == score.tile_id; });
  if (!same) {
    throw DataError("the scores are of other tiles than the plan (" + std::to_string(scores.size()) + " scores, " +
                    std::to_string(plan.tiles.size()) + " tiles); score the plan again");
  }
  return ordered;
}

std::vector<bool> samples_over(const TilePlan& plan, const TileLookup& lookup, const std::vector<bool>& chosen) {
  std::vector<bool> over(plan.route_samples.size());
  for (std::size_t i = 0; i < over.size(); ++i) {
    const auto tile = lookup.tile_under(plan.route_samples[i]);
    over[i] = tile && chosen[*tile];
  }
  return over;
}

// The matching areas around the fixes: every matchable tile in which the aircraft may find itself there.
std::vector<bool> sparse_areas(const TilePlan& plan, const std::vector<bool>& matchable,
                               const std::vector<bool>& can_fix, double max_error_m) {
  std::vector<bool> chosen(plan.tiles.size(), false);
  for (const std::size_t fix : fewest_fix_samples(plan, can_fix, max_error_m)) {
    const PlanSample& sample = plan.route_samples[fix];
    const TileMatrix& matrix = plan.levels[static_cast<std::size_t>(sample.level)].matrix;
    // Half the diagonal of a stride more, so that the tile of the fix is among them however narrow the corridor.
    const double half_diagonal_m = std::sqrt(0.5) * matrix.stride_px * matrix.map_from_pixel.x_per_col;
    const double reach_m = plan.corridor_half_width_m + half_diagonal_m;
    for (std::size_t i = 0; i < plan.tiles.size(); ++i) {
      const PlanTile& tile = plan.tiles[i];
      if (tile.level != sample.level || !matchable[i]) continue;
      if ((tile.bounds.center_m() - sample.point_map_m).norm() <= reach_m) chosen[i] = true;
    }
  }
  return chosen;
}

// Drops tiles until the rest fits: sparse areas stay longest, then what is near the route, then what stands out most.
std::vector<bool> within_budget(const TilePlan& plan, const std::vector<TileScore>& scores,
                                const std::vector<bool>& wanted, const std::vector<bool>& sparse,
                                const StoredSize& size, std::int64_t budget) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i]) order.push_back(i);
  }
  const auto rank = [&](std::size_t i) {
    const double stride_m = plan.levels[static_cast<std::size_t>(plan.tiles[i].level)].matrix.stride_px *
                            plan.levels[static_cast<std::size_t>(plan.tiles[i].level)].gsd_m;
    const double offset_m = plan.tiles[i].route_offset_m;
    const double ring = sparse[i] ? offset_m : std::floor(offset_m / (stride_m / 2));
    return std::tuple(!sparse[i], ring, -judged_margin(scores[i]), i);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  StorageCount count(plan, size);
  if (count.bytes() > static_cast<double>(budget)) {
    throw UsageError("budget = " + std::to_string(budget) + " bytes cannot hold even an empty map, which has " +
                     format_fixed(count.bytes(), 0));
  }
  std::vector<bool> kept(wanted.size(), false);
  for (const std::size_t i : order) {
    if (count.bytes_with(plan.tiles[i]) > static_cast<double>(budget)) continue;
    count.add(plan.tiles[i]);
    kept[i] = true;
  }
  return kept;
}

std::size_t count_true(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

}  // namespace

bool is_matchable(const TileScore& score, const SelectOptions& options) {
  if (score.status != TileStatus::kScored) return false;
  const double margin = judged_margin(score);
  return std::isnan(margin) || margin >= options.min_peak_margin;
}

Selection select_tiles(const TilePlan& plan, const std::vector<TileScore>& scores, const StoredSize& size,
                       const SelectOptions& options) {
  check_options(options);
  const double max_error_m = plan.max_error_m;
  const std::vector<TileScore> ordered = scores_of_plan(plan, scores);
  const TileLookup lookup(plan);

  std::vector<bool> matchable(plan.tiles.size());
  for (std::size_t i = 0; i < matchable.size(); ++i) matchable[i] = is_matchable(ordered[i], options);
  const std::vector<bool> sparse = sparse_areas(plan, matchable, samples_over(plan, lookup, matchable), max_error_m);
  std::vector<bool> chosen = options.sparse ? sparse : matchable;
  if (options.budget) {
    chosen = within_budget(plan, ordered, chosen, sparse, size, parse_byte_budget(*options.budget));
  }

  Selection selection;
  StorageCount count(plan, size);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    selection.tile_ids.push_back(plan.tiles[i].tile_id);
    count.add(plan.tiles[i]);
  }
  RouteError error = predict_route_error(plan, samples_over(plan, lookup, chosen), max_error_m, options.fix_interval_s);
  selection.gaps = std::move(error.gaps);
  selection.legs = std::move(error.legs);
  selection.error_profile = std::move(error.profile);
  selection.matchable_fraction = error.matchable_fraction;
  selection.within_limit = error.within_limit;
  selection.max_error_m = max_error_m;
  selection.sigma_multiple = plan.ins.sigma_multiple;
  selection.estimated_bytes = static_cast<std::int64_t>(std::ceil(count.bytes()));
  selection.notes.push_back(std::to_string(count_true(matchable)) + " of " + std::to_string(plan.tiles.size()) +
                            " tiles can be matched; " + std::to_string(selection.tile_ids.size()) + " are stored");
  return selection;
}

}  // namespace pilotage
