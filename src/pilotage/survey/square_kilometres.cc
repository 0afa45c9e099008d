#include "pilotage/survey/square_kilometres.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/base/statistics.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

constexpr double kMetresPerKilometre = 1000;

bool is_go(const TileScores& scores) {
  return tile_class(scores) == TileClass::kGo;
}

}  // namespace

double AreaStatistics::share(std::int64_t of_tiles) const {
  return tiles.all() == 0 ? kNaN : static_cast<double>(of_tiles) / static_cast<double>(tiles.all());
}

AreaStatistics area_statistics(const std::vector<const TileScores*>& tiles, double cell_km2) {
  AreaStatistics statistics;
  std::vector<double> probabilities;
  std::vector<const TileScores*> weak;
  for (const TileScores* tile : tiles) {
    const std::optional<TileClass> known = tile_class(*tile);
    if (!known) {
      ++statistics.tiles.not_known;
    } else {
      ++(*known == TileClass::kGo         ? statistics.tiles.go
         : *known == TileClass::kMarginal ? statistics.tiles.marginal
                                          : statistics.tiles.no_go);
    }
    if (known != TileClass::kGo) weak.push_back(tile);
    if (!std::isnan(tile->p_correct_fix)) probabilities.push_back(tile->p_correct_fix);
  }
  statistics.area_km2 = cell_km2 * static_cast<double>(tiles.size());
  statistics.median_p_correct_fix = quantile(std::move(probabilities), 0.5);
  statistics.reasons = count_reasons(weak);
  return statistics;
}

double cell_km2(const GridLevel& level) {
  const double stride_km = level.matrix.stride_px * level.gsd_m / kMetresPerKilometre;
  return stride_km * stride_km;
}

std::vector<SquareKilometre> square_kilometres(const ScoreTable& table) {
  const auto kilometre = [](double metres) {
    return static_cast<std::int64_t>(std::floor(metres / kMetresPerKilometre));
  };
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<const TileScores*>> squares;  // by −north, east
  for (std::size_t i = 0; i < table.scores.size(); ++i) {
    const Eigen::Vector2d center = table.ground.tiles[i].bounds.center_m();
    squares[{-kilometre(center.y()), kilometre(center.x())}].push_back(&table.scores[i]);
  }
  const double cell = cell_km2(table.ground.levels.front());
  const CrsTransform transform(table.ground.crs);
  std::vector<SquareKilometre> result;
  for (const auto& [place, tiles] : squares) {
    SquareKilometre& square = result.emplace_back();
    square.north_km = -place.first;
    square.east_km = place.second;
    square.center = transform
                        .geodetic_from_map({(static_cast<double>(square.east_km) + 0.5) * kMetresPerKilometre,
                                            (static_cast<double>(square.north_km) + 0.5) * kMetresPerKilometre})
                        .value_or(GeodeticPoint{kNaN, kNaN});
    square.statistics = area_statistics(tiles, cell);
  }
  return result;
}

double farthest_from_go_m(const ScoreTable& table) {
  if (std::none_of(table.scores.begin(), table.scores.end(), is_go)) return kNaN;
  constexpr std::uint8_t kGoes = 0;  // from which distances are counted
  constexpr std::uint8_t kWeak = 1;
  const cv::Mat cells = class_raster(table, 0, [](const TileScores& tile) { return is_go(tile) ? kGoes : kWeak; });
  cv::Mat away;  // in cells; exact to the precision of 32 bits
  cv::distanceTransform(cells, away, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double farthest = 0;
  cv::minMaxLoc(away, nullptr, &farthest, nullptr, nullptr, cells == kWeak);
  const GridLevel& level = table.ground.levels.front();
  return farthest * level.matrix.stride_px * level.gsd_m;
}

}  // namespace pilotage
