#include "pilotage/report/compare_reports.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/wording.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/report/report_file.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kChangedP = 0.01;
constexpr double kPlaceShare = 0.71;  // of the stride: the centre of a cell is that far from its corners
constexpr double kSameGrid_m = 1;

bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

/// The longest gap of the route; all 0 without gaps.
ReportGap longest_gap(const Report& report) {
  ReportGap longest;
  for (const ReportGap& gap : report.gaps) {
    if (!(gap.length_m <= longest.length_m)) longest = gap;
  }
  return longest;
}

/// NaN without probabilities.
RouteProbability probability_of(const Report& report) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  return report.probability.value_or(RouteProbability{kUnknown, kUnknown, kUnknown, kUnknown, {}, {}});
}

std::vector<ComparedNumber> numbers_of(const Report& a, const Report& b) {
  using R = const Report&;
  const auto both = [&](auto get) { return Both<double>{static_cast<double>(get(a)), static_cast<double>(get(b))}; };
  const auto chance = [&](double RouteProbability::*member) {
    return Both<double>{probability_of(a).*member, probability_of(b).*member};
  };
  return {
      {"p_within_limit", "P(within the limit all the way)", "", 3, chance(&RouteProbability::p_within_limit)},
      {"longest_gap_m", "Longest gap", "m", 0, both([](R r) { return longest_gap(r).length_m; })},
      {"longest_gap_s", "Longest gap", "s", 0, both([](R r) { return longest_gap(r).gap.duration_s; })},
      {"gaps", "Gaps", "", 0, both([](R r) { return r.gaps.size(); })},
      {"largest_error_m", "Largest predicted error", "m", 1, both([](R r) { return r.largest_error_m; })},
      {"max_error_m", "Limit of the error", "m", 1, both([](R r) { return r.max_error_m; })},
      {"matchable_fraction", "Share of the route over areas", "", 3, both([](R r) { return r.matchable_fraction; })},
      {"expected_fixes", "Expected correct fixes", "", 1, chance(&RouteProbability::expected_fixes)},
      {"expected_false_fixes", "Expected false fixes, at most", "", 4, chance(&RouteProbability::expected_false_fixes)},
      {"route_length_m", "Length of the route", "m", 0, both([](R r) { return r.route_length_m; })},
      {"tiles", "Tiles", "", 0, both([](R r) { return r.tiles.size(); })},
      {"selected_tiles", "Matching areas", "", 0, both([](R r) { return r.selected_tiles; })},
      {"estimated_bytes", "Estimated size of the map", "bytes", 0, both([](R r) { return r.estimated_bytes; })},
  };
}

std::vector<ComparedQuality> changed_quality(const Report& a, const Report& b) {
  std::vector<ComparedQuality> rows;
  for (const QualityRow& row : a.quality) {
    rows.push_back({row.name, row.label, {row.value, ""}, {std::string(status_name(row.status)), ""}});
  }
  for (const QualityRow& row : b.quality) {
    auto found = std::find_if(rows.begin(), rows.end(), [&](const auto& known) { return known.name == row.name; });
    if (found == rows.end()) found = rows.insert(rows.end(), {row.name, row.label, {}, {}});
    found->values[1] = row.value;
    found->statuses[1] = status_name(row.status);
  }
  std::erase_if(rows, [](const ComparedQuality& row) {
    return row.values[0] == row.values[1] && row.statuses[0] == row.statuses[1];
  });
  return rows;
}

/// A leg by its ends and how often they have come before.
using LegKey = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t, int>;

std::vector<LegKey> leg_keys(const Report& report) {
  const auto rounded = [](double degrees) -> std::int64_t {
    return std::isfinite(degrees) ? std::llround(degrees * 1e5) : std::numeric_limits<std::int64_t>::min();
  };
  std::set<LegKey> seen;
  std::vector<LegKey> keys;
  for (const ReportLeg& leg : report.legs) {
    LegKey key{rounded(leg.from.lon_deg), rounded(leg.from.lat_deg), rounded(leg.to.lon_deg), rounded(leg.to.lat_deg),
               0};
    while (!seen.insert(key).second) ++std::get<4>(key);
    keys.push_back(key);
  }
  return keys;
}

void compare_legs(const Report& a, const Report& b, ReportComparison& comparison) {
  std::map<LegKey, std::size_t> of_a;
  const std::vector<LegKey> keys_a = leg_keys(a);
  for (std::size_t i = 0; i < keys_a.size(); ++i) of_a[keys_a[i]] = i;
  const auto is_worst = [](const Report& report, std::size_t index) {
    return std::find(report.worst_legs.begin(), report.worst_legs.end(), static_cast<int>(index)) !=
           report.worst_legs.end();
  };
  const std::vector<LegKey> keys_b = leg_keys(b);
  for (std::size_t i = 0; i < keys_b.size(); ++i) {
    const ReportLeg& after = b.legs[i];
    const auto found = of_a.extract(keys_b[i]);
    if (found.empty()) {
      comparison.legs_of_one[1].push_back(after.status.leg + 1);
      continue;
    }
    const ReportLeg& before = a.legs[found.mapped()];
    ++comparison.common_legs;
    if (before.quality == after.quality && same_number(before.status.max_error_m, after.status.max_error_m) &&
        same_number(before.status.p_within_limit, after.status.p_within_limit)) {
      continue;
    }
    comparison.legs.push_back({{before.status.leg + 1, after.status.leg + 1},
                               after.from,
                               after.to,
                               {std::string(status_name(before.quality)), std::string(status_name(after.quality))},
                               {before.status.p_within_limit, after.status.p_within_limit},
                               {before.status.max_error_m, after.status.max_error_m},
                               {is_worst(a, found.mapped()), is_worst(b, i)}});
  }
  for (const auto& [key, index] : of_a) comparison.legs_of_one[0].push_back(a.legs[index].status.leg + 1);
  std::sort(comparison.legs_of_one[0].begin(), comparison.legs_of_one[0].end());
  const auto badness = [](const ComparedLeg& leg) {
    const double p_excess = std::isnan(leg.p_within_limit[1]) ? 1 : 1 - leg.p_within_limit[1];
    const double error_m = leg.max_error_m[1];
    return std::pair(p_excess, std::isnan(error_m) ? std::numeric_limits<double>::infinity() : error_m);
  };
  std::stable_sort(comparison.legs.begin(), comparison.legs.end(),
                   [&](const ComparedLeg& x, const ComparedLeg& y) { return badness(x) > badness(y); });
}

/// Finds tiles of one report by place. Cells of space of the size of the largest distance hold what is near.
class TilePlaces {
 public:
  TilePlaces(const std::vector<ReportTile>& tiles, GeodeticPoint origin, double reach_m)
      : frame_(origin), reach_m_(reach_m) {
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      points_.push_back(place(tiles[i].tile.center));
      if (points_.back().allFinite()) cells_[cell_of(tiles[i].tile.level, points_.back())].push_back(i);
    }
  }

  /// The tiles of this level within the reach, by distance and index.
  std::vector<std::pair<double, std::size_t>> near(int level, GeodeticPoint center) const {
    std::vector<std::pair<double, std::size_t>> found;
    const Eigen::Vector3d point = place(center);
    if (!point.allFinite()) return found;
    const auto [key_level, x, y, z] = cell_of(level, point);
    for (std::int64_t neighbour = 0; neighbour < 27; ++neighbour) {
      const auto cell =
          cells_.find({key_level, x + neighbour % 3 - 1, y + neighbour / 3 % 3 - 1, z + neighbour / 9 - 1});
      if (cell == cells_.end()) continue;
      for (const std::size_t i : cell->second) {
        const double distance_m = (points_[i] - point).norm();
        if (distance_m <= reach_m_) found.emplace_back(distance_m, i);
      }
    }
    return found;
  }

 private:
  using Cell = std::tuple<int, std::int64_t, std::int64_t, std::int64_t>;

  Eigen::Vector3d place(GeodeticPoint point) const {
    if (!std::isfinite(point.lon_deg) || !(std::abs(point.lat_deg) <= 90)) {
      return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    return frame_.enu_from_geodetic(point);
  }
  Cell cell_of(int level, const Eigen::Vector3d& point) const {
    const auto index = [&](double coordinate) { return static_cast<std::int64_t>(std::floor(coordinate / reach_m_)); };
    return {level, index(point.x()), index(point.y()), index(point.z())};
  }

  LocalFrame frame_;
  double reach_m_;
  std::vector<Eigen::Vector3d> points_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

double reach_of(const Report& a, const Report& b) {
  double stride_m = std::numeric_limits<double>::infinity();
  for (const Report* report : {&a, &b}) {
    for (const GridLevel& level : report->levels) stride_m = std::min(stride_m, level.gsd_m * level.matrix.stride_px);
  }
  return std::isfinite(stride_m) && stride_m > 0 ? kPlaceShare * stride_m : 1;
}

/// Index of the first report's tile for each tile of the second; each at most once, nearest pairs first.
struct PairedTiles {
  std::vector<std::optional<std::size_t>> of_b;
  double farthest_m = 0;
};

PairedTiles pair_tiles(const Report& a, const Report& b) {
  GeodeticPoint origin;  // any point does: distances are the same in every frame
  for (const ReportTile& tile : b.tiles) {
    const GeodeticPoint center = tile.tile.center;
    if (std::isfinite(center.lon_deg) && std::abs(center.lat_deg) <= 90) origin = center;
  }
  const TilePlaces places(a.tiles, origin, reach_of(a, b));
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> pairs;  // distance, tile of b, tile of a
  for (std::size_t i = 0; i < b.tiles.size(); ++i) {
    for (const auto& [distance_m, index] : places.near(b.tiles[i].tile.level, b.tiles[i].tile.center)) {
      pairs.emplace_back(std::llround(distance_m * 10), i, index);  // noise of the grids decides nothing
    }
  }
  std::sort(pairs.begin(), pairs.end());
  PairedTiles paired;
  paired.of_b.resize(b.tiles.size());
  std::vector<bool> taken(a.tiles.size());
  for (const auto& [distance_dm, of_b, of_a] : pairs) {
    if (paired.of_b[of_b] || taken[of_a]) continue;
    paired.of_b[of_b] = of_a;
    taken[of_a] = true;
    paired.farthest_m = std::max(paired.farthest_m, static_cast<double>(distance_dm) / 10);
  }
  return paired;
}

ComparedArea area_of(const ReportTile* before, const ReportTile* after) {
  const ReportTile& shown = after != nullptr ? *after : *before;
  ComparedArea area{shown.tile.level, shown.tile.center, {}, {}};
  area.p_correct_fix.fill(std::numeric_limits<double>::quiet_NaN());
  for (const auto& [side, tile] : {std::pair(std::size_t{0}, before), std::pair(std::size_t{1}, after)}) {
    if (tile == nullptr) continue;
    area.tile_ids[side] = tile->tile.tile_id;
    area.p_correct_fix[side] = tile->score.p_correct_fix;
  }
  return area;
}

void compare_areas(const Report& a, const Report& b, ReportComparison& comparison) {
  const PairedTiles paired = pair_tiles(a, b);
  std::vector<const ReportTile*> after_of_a(a.tiles.size(), nullptr);
  for (std::size_t i = 0; i < b.tiles.size(); ++i) {
    const ReportTile& after = b.tiles[i];
    const ReportTile* before = paired.of_b[i] ? &a.tiles[*paired.of_b[i]] : nullptr;
    if (before != nullptr) after_of_a[*paired.of_b[i]] = &after;
    if (!after.selected) continue;
    if (before == nullptr || !before->selected) {
      comparison.added.push_back(area_of(before, &after));
      continue;
    }
    ++comparison.kept_areas;
    const double p_before = before->score.p_correct_fix;
    const double p_after = after.score.p_correct_fix;
    const bool changed =
        std::isnan(p_before) != std::isnan(p_after) || std::abs(p_after - p_before) >= kChangedP;  // NaN compares false
    if (changed) comparison.changed.push_back(area_of(before, &after));
  }
  for (std::size_t i = 0; i < a.tiles.size(); ++i) {
    const ReportTile* after = after_of_a[i];
    if (!a.tiles[i].selected || (after != nullptr && after->selected)) continue;
    comparison.removed.push_back(area_of(&a.tiles[i], after));
  }
  const auto change = [](const ComparedArea& entry) {
    const double difference = std::abs(entry.p_correct_fix[1] - entry.p_correct_fix[0]);
    return std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
  };
  std::stable_sort(comparison.changed.begin(), comparison.changed.end(),
                   [&](const ComparedArea& x, const ComparedArea& y) { return change(x) > change(y); });
  if (paired.farthest_m >= kSameGrid_m) {
    comparison.notes.push_back("The plans lie on different grids: areas whose centres are up to " +
                               length_text(paired.farthest_m) + " apart count as the same place.");
  }
}

/// Values by dotted path, in the order of the document; empty objects are values.
void flatten(const Json& json, const std::string& path, std::vector<std::pair<std::string, Json>>& list) {
  if (!json.is_object() || json.empty()) {
    if (!path.empty()) list.emplace_back(path, json);
    return;
  }
  for (const auto& [key, value] : json.items()) flatten(value, path.empty() ? key : path + "." + key, list);
}

std::vector<ComparedEntry> changed_entries(const std::vector<std::pair<std::string, Json>>& a,
                                           const std::vector<std::pair<std::string, Json>>& b) {
  std::vector<ComparedEntry> entries;
  for (const auto& [name, value] : a) entries.push_back({name, {value, nullptr}});
  for (const std::pair<std::string, Json>& next : b) {
    auto found = std::find_if(entries.begin(), entries.end(),
                              [&](const ComparedEntry& entry) { return entry.name == next.first; });
    if (found == entries.end()) found = entries.insert(entries.end(), {next.first, {}});
    found->values[1] = next.second;
  }
  std::erase_if(entries, [](const ComparedEntry& entry) { return entry.values[0] == entry.values[1]; });
  return entries;
}

std::vector<std::pair<std::string, Json>> flattened(const Json& json) {
  std::vector<std::pair<std::string, Json>> list;
  flatten(json, "", list);
  return list;
}

/// Inputs by role; of several with one role the first goes with the first.
std::vector<std::pair<std::string, Json>> named_inputs(const Report& report) {
  std::map<std::string, int> counts;
  std::vector<std::pair<std::string, Json>> list;
  for (const InputFile& input : report.inputs) {
    const int count = ++counts[input.role];
    list.emplace_back(input.role + (count == 1 ? "" : " " + std::to_string(count)),
                      Json{{"name", input.name}, {"date", input.date}, {"digest", input.digest}});
  }
  return list;
}

bool nothing_differs(const ReportComparison& c) {
  const bool numbers = std::all_of(c.numbers.begin(), c.numbers.end(), [](const ComparedNumber& number) {
    return same_number(number.values[0], number.values[1]);
  });
  return numbers && c.verdict_texts[0] == c.verdict_texts[1] && c.verdict_statuses[0] == c.verdict_statuses[1] &&
         c.quality.empty() && c.legs.empty() && c.legs_of_one[0].empty() && c.legs_of_one[1].empty() &&
         c.added.empty() && c.removed.empty() && c.changed.empty() && c.inputs.empty() && c.parameters.empty() &&
         c.grid.empty();
}

}  // namespace

ReportComparison compare_reports(const Report& a, const Report& b, const Both<std::string>& files) {
  ReportComparison comparison;
  comparison.files = files;
  comparison.titles = {a.title, b.title};
  comparison.software_versions = {a.software_version, b.software_version};
  comparison.verdict_statuses = {std::string(verdict_name(a.verdict)), std::string(verdict_name(b.verdict))};
  comparison.verdict_texts = {a.verdict_text, b.verdict_text};
  comparison.numbers = numbers_of(a, b);
  comparison.quality = changed_quality(a, b);
  compare_legs(a, b, comparison);
  compare_areas(a, b, comparison);
  comparison.inputs = changed_entries(named_inputs(a), named_inputs(b));
  comparison.grid = changed_entries(flattened(grid_json(a)), flattened(grid_json(b)));
  if (a.parameters.empty() == b.parameters.empty()) {
    comparison.parameters = changed_entries(flattened(a.parameters), flattened(b.parameters));
  } else {
    comparison.notes.push_back(files[a.parameters.empty() ? 0 : 1] +
                               " holds no options (`pilotage prepare` stores them), so they are not compared.");
  }
  if (a.software_version != b.software_version) {
    comparison.notes.push_back("Written by different versions (" + a.software_version + ", " + b.software_version +
                               "): numbers may differ for that reason alone.");
  }
  comparison.same = nothing_differs(comparison);
  return comparison;
}

}  // namespace pilotage
