#include "pilotage/registration/register_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

/// Squares of ground that hold a tile.
class Occupied {
 public:
  Occupied(const std::vector<Bounds>& tiles, const Bounds& area_m, double cell_m)
      : area_m_(area_m),
        cell_m_(cell_m),
        columns_(static_cast<int>(area_m.width_m() / cell_m) + 1),
        cells_(static_cast<std::size_t>(columns_) * (static_cast<std::size_t>(area_m.height_m() / cell_m) + 1), 0) {
    for (const Bounds& tile : tiles) {
      for_each_cell(tile, [&](std::size_t cell) { cells_[cell] = 1; });
    }
  }
  bool touches(const Bounds& bounds) const {
    bool found = false;
    for_each_cell(bounds, [&](std::size_t cell) { found = found || cells_[cell] != 0; });
    return found;
  }

 private:
  template <class Use>
  void for_each_cell(const Bounds& bounds, const Use& use) const {
    const auto rows = static_cast<int>(cells_.size()) / columns_;
    const auto index = [&](double offset_m, int count) {
      return static_cast<int>(std::clamp(std::floor(offset_m / cell_m_), 0.0, count - 1.0));
    };
    if (!bounds.intersects(area_m_)) return;
    for (int row = index(bounds.min_y_m - area_m_.min_y_m, rows); row <= index(bounds.max_y_m - area_m_.min_y_m, rows);
         ++row) {
      for (int col = index(bounds.min_x_m - area_m_.min_x_m, columns_);
           col <= index(bounds.max_x_m - area_m_.min_x_m, columns_); ++col) {
        use(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(col));
      }
    }
  }

  Bounds area_m_;
  double cell_m_;
  int columns_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace

TileRegistration register_tiles(const std::vector<std::string>& reference, const ImageryOptions& imagery,
                                const std::vector<std::string>& second, const Crs& crs,
                                const std::vector<Bounds>& tiles, const RegistrationOptions& options, int threads,
                                const Progress& progress) {
  TileRegistration result;
  std::vector<ImageryInfo> infos;
  for (const std::string& dataset : reference) infos.push_back(inspect_imagery(dataset, imagery));
  for (const std::string& dataset : second) infos.push_back(inspect_imagery(dataset, second_date_options(imagery)));
  if (tiles.empty()) return result;
  double largest_m = 1;
  for (const Bounds& tile : tiles) {
    result.area_m.extend({tile.min_x_m, tile.min_y_m});
    result.area_m.extend({tile.max_x_m, tile.max_y_m});
    largest_m = std::max(largest_m, tile.width_m());
  }
  const Occupied occupied(tiles, result.area_m, largest_m);
  result.registration = register_dates(
      open_rasters(reference, imagery, second, crs), result.area_m, registration_gsd_m(infos, options), options,
      [&](const Bounds& bounds) { return occupied.touches(bounds); }, threads, progress);
  return result;
}

}  // namespace pilotage
