#include "pilotage/mission/chances_beside_line.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pilotage/mission/tile_under.h"

namespace pilotage {

double ChancesBesideLine::share_at(double sigma_m) const {
  if (step_m == 0) return 1;
  const double quarters = 4 * sigma_m / step_m;
  if (quarters <= 1) return 1 + quarters * (shares[0] - 1);
  if (quarters <= 2) return shares[0] + (quarters - 1) * (shares[1] - shares[0]);
  return shares[1] + std::min(1.0, (quarters - 2) / 2) * (shares[2] - shares[1]);
}

ChancesBesideLine chances_beside_line(const Mission& mission, const FlightSample& on_line,
                                      const std::vector<double>& p_of_tile) {
  const std::optional<std::size_t> below = tile_under(mission, on_line);
  ChancesBesideLine beside;
  if (!below || !(p_of_tile[*below] > 0)) return beside;
  const TileMatrix& matrix = mission.ground.levels[static_cast<std::size_t>(on_line.level)].matrix;
  beside.step_m = matrix.stride_px * std::abs(matrix.map_from_pixel.x_per_col);
  // Rings of equal probability, each point turned by the golden angle.
  constexpr int kPoints = 40;
  constexpr double kGoldenAngle_rad = 2.399963229728653;
  for (std::size_t k = 0; k < beside.shares.size(); ++k) {
    const double sigma_m = beside.step_m / std::exp2(2 - static_cast<double>(k));
    double p = 0;
    for (int i = 0; i < kPoints; ++i) {
      const double off_m = sigma_m * std::sqrt(-2 * std::log(1 - (i + 0.5) / kPoints));
      FlightSample there = on_line;
      there.point_map_m += off_m * Eigen::Vector2d(std::cos(kGoldenAngle_rad * i), std::sin(kGoldenAngle_rad * i));
      const std::optional<std::size_t> tile = tile_under(mission, there);
      if (tile) p += p_of_tile[*tile] / kPoints;
    }
    beside.shares[k] = p / p_of_tile[*below];
  }
  return beside;
}

}  // namespace pilotage
