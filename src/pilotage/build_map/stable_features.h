#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/ground.h"
#include "pilotage/registration/feature_fates.h"
#include "pilotage/registration/registration_options.h"
#include "pilotage/registration/warp_field.h"
#include "pilotage/vision/feature_set.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Which features of the selected ground a map stores.
enum class KeepFeatures {
  kAll,
  kStable,  ///< Not those that a second date contradicts.
};

inline EnumNames<KeepFeatures> enum_names(KeepFeatures) {
  return {{KeepFeatures::kAll, "all"}, {KeepFeatures::kStable, "stable"}};
}

/// A second date and where it shows the ground of the reference.
struct SecondDate {
  std::vector<std::string> datasets;
  WarpField field;  ///< In the CRS of the ground.
};

/// Registers a second date over all tiles of a ground: the field is that of scoring it with the same options.
/// Throws as register_tiles.
SecondDate register_second_date(const Ground& ground, const std::vector<std::string>& datasets,
                                const RegistrationOptions& options, int threads = 0, const Progress& progress = {});

/// The second date on the grid of a level as the reference shows the ground, CV_8U; not valid where the field is not
/// known.
GraySource open_second_date(const SecondDate& second, const Ground& ground, const GridLevel& level);

/// What became of the features of the selected ground.
struct StableStats {
  std::int64_t survived = 0;
  std::int64_t not_known = 0;  ///< Kept, because the second date says nothing of them.
  std::int64_t dropped = 0;
  std::int64_t refilled = 0;  ///< Contradicted and kept all the same, so that their tile is not left empty.
  std::int64_t tiles_refilled = 0;
};

/// Fewest features in the window of a tile, as long as the tile has so many.
inline constexpr std::int64_t kLeastFeatures = 20;

/// How many features are kept in the window of each tile of a matrix, whichever tile stores them.
class WindowCounts {
 public:
  explicit WindowCounts(const TileMatrix& matrix) : matrix_(matrix) {}
  /// A feature in pixels of the grid.
  void add(double x_px, double y_px);
  /// The number for a tile, which is then forgotten.
  std::int64_t take(std::int64_t column, std::int64_t row);

 private:
  TileMatrix matrix_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> counts_;  // by (row, column)
};

/// Removes what the second date contradicts from the features that a tile owns (`ground_height_m` has one for each or
/// is empty). `kept_in_window` features are kept in the window of the tile already, its own included; while these are
/// fewer than kLeastFeatures, the strongest of the contradicted ones (highest response, the first on a tie) stay. The
/// order is kept.
void drop_contradicted(FeatureSet& features, std::vector<float>& ground_height_m, const std::vector<FeatureFate>& fates,
                       std::int64_t kept_in_window, StableStats& stats);

}  // namespace pilotage

#pragma GCC visibility pop
