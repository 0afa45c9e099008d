#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/ground/measures.h"

#pragma GCC visibility push(default)

namespace pilotage {

struct Rgb {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  bool operator==(const Rgb&) const = default;
};

/// The 256 colours of a map, low values first.
std::array<Rgb, 256> color_table(ColorMap map);

/// "#rrggbb"
std::string hex_color(Rgb color);

/// A measure with the range its colours span: the 2nd to the 98th percentile (nearest rank) of its defined values, so
/// that a few extreme tiles do not wash out the rest; values beyond take the end colours. Shares
/// span 0 to 1, but for those that rank the ground (HeatMap::ranks): these span at least kLeastSpan of what it has.
struct MeasureScale {
  static constexpr double kLeastSpan = 0.1;  ///< Of a share that ranks: less is no difference to colour.

  Measure measure;
  double low = 0;
  double high = 1;   ///< > low.
  double least = 0;  ///< Smallest and largest defined value; NaN when there is none.
  double most = 0;
};

MeasureScale measure_scale(const Measure& measure, const std::vector<TileScores>& scores);

/// Index into color_table, or -1 where the value is not defined.
int shade(const MeasureScale& scale, double value);

}  // namespace pilotage

#pragma GCC visibility pop
