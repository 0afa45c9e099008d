#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/color_source.h"

namespace pilotage {

/// What the ground of a tile is made of, as far as colour and texture tell, and which way its edges run.
struct GroundCover {
  /// Share of the tile's ground that is green, 0 … 1; NaN where the imagery has no colours.
  double vegetation_share = std::numeric_limits<double>::quiet_NaN();
  /// Share of the tile's ground that looks like open water: smooth over some twenty pixels, dark, and not red; without
  /// colours smooth and darker still. Muddy water is not told from bare ground.
  double water_share = std::numeric_limits<double>::quiet_NaN();
  /// Smaller over larger eigenvalue of the structure tensor Σ∇g∇gᵀ of the tile's gray values, gradients at a Gaussian
  /// sigma of 2 px: 1 where edges run in all directions, 0 where all run in one and a fix slides along them (the
  /// aperture problem; J. Bigün and G. Granlund, "Optimal Orientation Detection of Linear Symmetry", ICCV 1987). NaN
  /// without any gradient.
  double aperture = std::numeric_limits<double>::quiet_NaN();
};

/// A pixel is green when its green leaf index (2G − R − B)/(2G + R + B) (M. Louhaichi, M. Borman, D. Johnson,
/// "Spatially Located Platform and Aerial Photography for Documentation of Grazing Impacts on Wheat", Geocarto
/// International 16(1), 2001), of colours averaged over 5 × 5 px, is at least this, and it is no water.
inline constexpr double kGreenLeafIndex = 0.05;

/// A pixel may be water when over 9 × 9 px the standard deviation of gray is below this share of the mean + 8 levels…
inline constexpr double kSmoothContrast = 0.03;
/// … its mean is below these shares of white (with and without colours), …
inline constexpr double kDarkColored = 0.55;
inline constexpr double kDarkGray = 0.4;
/// … its green leaf index is below this, blue is not below red, and of the 31 × 31 px around this share is alike.
inline constexpr double kWaterGreenLeafIndex = 0.08;
inline constexpr double kWaterMajority = 0.66;

/// The value that white has: 255 for 8-bit imagery, the gray value that 99.5 % of a sample stay below (find_stretch)
/// for all other.
double white_of(const ColorSource& colors);

/// The ground cover of tiles of `matrix`, whose pixel grid is that of `colors`. Result i belongs to `tile_indices[i]`,
/// index = row · matrix_width + column; an empty list means all tiles, in this order. `white` is white_of() the colours
/// where the caller knows it, else it is measured. The bands of imagery of other than 8 bits must be red, green and
/// blue in one scale. A tile of which nearly all pixels are neutral (red = green = blue) counts as without colours.
/// What the thresholds are worth: docs/methods/reasons.md.
///
/// Streams groups of neighbouring tiles of about 1,000 × 1,000 px, one per thread in memory. Integer arithmetic: the
/// result depends neither on `threads` (0 = all cores) nor on which other tiles are asked for. Throws UsageError for an
/// index out of range, DataError when the matrix is not that of the imagery or reading fails; Interrupted.
std::vector<GroundCover> measure_ground_cover(const ColorSource& colors, const TileMatrix& matrix,
                                              std::span<const std::int64_t> tile_indices, int threads = 0,
                                              const Progress& progress = {}, std::optional<double> white = {});

}  // namespace pilotage
