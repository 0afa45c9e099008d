#include "pilotage/raster/elevation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/height_unit.h"

namespace pilotage {
namespace {

constexpr int kBlockSide = 256;
constexpr std::size_t kBlocksKept = 32;  // 32 × 256² doubles and masks: 19 MB
/// Models of so many blocks are looked through for voids as a whole, larger ones around the route, there so many
/// blocks.
constexpr std::int64_t kBlocksOfWhole = 64;
constexpr std::int64_t kBlocksAround = 256;
constexpr double kHighestGround_m = 9000;   // Everest: 8,849 m
constexpr double kLowestGround_m = -12000;  // Challenger Deep: -10,935 m
constexpr double kLowestLand_m = -500;      // Dead Sea: -430 m
constexpr double kCliff_m = 20;

/// Whether no ground has that height: what is left of a void that was not declared.
bool is_no_height(double stored, double metres) {
  if (!(metres <= kHighestGround_m && metres >= kLowestGround_m)) return true;
  if (metres >= kLowestLand_m) return false;  // else the floor of a sea, unless it is one of the usual marks
  return stored == -32768 || stored == -32767 || stored == -9999 || stored == -999;
}

/// Marks that can be heights as well.
bool may_be_no_height(double stored) {
  return stored == 0 || stored == -99;
}

/// What is met of a value that may stand for no height.
struct VoidCount {
  bool certain = false;
  std::int64_t pixels = 0;
  std::int64_t cliffs = 0;  ///< Heights beside it that lie far from it,
  std::int64_t slopes = 0;  ///< and near it.
  GeodeticPoint first;
};

ImageryOptions height_options(const std::string& crs) {
  ImageryOptions options;
  options.bands = {1};
  options.imagery_crs = crs;
  options.collar = CollarRule::kKeep;  // 0 is a height: the sea's
  return options;
}

}  // namespace

struct Elevation::Impl {
  struct Block {
    std::int64_t col = 0;
    std::int64_t row = 0;
    Raster raster;
  };

  ImageryInfo info;
  GraySource source;
  CrsTransform map_from_geodetic;
  std::optional<HeightTransform> height_transform;
  double metres_per_unit = 1;
  double center_x = 0;  // of the raster, in its CRS
  bool in_degrees = false;
  std::string vertical_datum;
  bool datum_assumed = false;
  std::list<Block> blocks;  // the last used first

  explicit Impl(const std::string& dataset, const std::string& crs)
      : info(inspect_imagery(dataset, height_options(crs))),
        source(open_gray(dataset, height_options(crs))),
        map_from_geodetic(info.crs),
        center_x(info.map_from_pixel.map_from_pixel({info.width_px / 2.0, info.height_px / 2.0}).x()),
        in_degrees(info.crs.is_geographic()) {
    choose_datum();
  }

  void choose_datum() {
    if (info.crs.has_height()) {
      try {
        height_transform.emplace(info.crs);
        if (amsl_at_center_works()) {
          vertical_datum = "heights of \"" + info.crs.name() + "\", transformed to metres above mean sea level (EGM96)";
          return;
        }
      } catch (const DataError&) {
        // No grid for it here: fall through to the assumption.
      }
      height_transform.reset();
    }
    const std::optional<double> metres = metres_per_height_unit(info.unit);
    if (!metres) {
      throw DataError(
          info.dataset + ": its heights are in \"" + info.unit.substr(0, 40) +
          "\", a unit that is not known; known are metre, foot, US survey foot, Clarke's, Indian and British "
          "foot, yard, dm, cm, mm and km: say it with gdal_edit.py -units m");
    }
    metres_per_unit = *metres;
    datum_assumed = true;
    vertical_datum = "assumed to be metres above mean sea level";
    if (*metres != 1) vertical_datum = "assumed to be above mean sea level, in " + info.unit;
    if (info.crs.has_height()) {
      vertical_datum += " (PROJ has no grid here to transform the heights of \"" + info.crs.name() + "\")";
    } else if (const auto geoid_m = geoid_at_center_m()) {
      vertical_datum += " (above the ellipsoid the ground would lie " + format_fixed(std::abs(*geoid_m), 1) + " m " +
                        (*geoid_m > 0 ? "lower" : "higher") + ")";
    }
  }

  /// Of EGM96 above the WGS 84 ellipsoid; nothing where PROJ has no grid for it.
  std::optional<double> geoid_at_center_m() const {
    try {
      const HeightTransform ellipsoid(Crs::from_user_input("EPSG:4979"));
      const auto amsl_m = ellipsoid.amsl_m({info.center.lon_deg, info.center.lat_deg}, 0);
      return amsl_m ? std::optional(-*amsl_m) : std::nullopt;
    } catch (const DataError&) {
      return std::nullopt;
    }
  }

  bool amsl_at_center_works() const {
    const Eigen::Vector2d middle = info.map_from_pixel.map_from_pixel({info.width_px / 2.0, info.height_px / 2.0});
    return height_transform->amsl_m(middle, 0).has_value();
  }

  /// The height of a pixel as stored; NaN for no data.
  double stored(std::int64_t col, std::int64_t row) {
    const Block& block = block_of(col / kBlockSide, row / kBlockSide);
    const auto x = static_cast<int>(col % kBlockSide);
    const auto y = static_cast<int>(row % kBlockSide);
    const double value = value_of(block.raster, x, y);
    return is_no_height(value, metres_of(value)) ? kNaN : value;
  }

  /// As stored; NaN for what is declared to be no data.
  static double value_of(const Raster& raster, int x, int y) {
    if (raster.valid.at<std::uint8_t>(y, x) == 0) return kNaN;
    const cv::Mat& pixels = raster.pixels;
    switch (pixels.depth()) {
      case CV_8U:
        return pixels.at<std::uint8_t>(y, x);
      case CV_16U:
        return pixels.at<std::uint16_t>(y, x);
      default:
        return pixels.at<double>(y, x);
    }
  }

  double metres_of(double stored) const { return (stored * info.scale + info.offset) * metres_per_unit; }

  PixelWindow block_window(std::int64_t col, std::int64_t row) const {
    const std::int64_t first_col = col * kBlockSide;
    const std::int64_t first_row = row * kBlockSide;
    return {first_col, first_row, static_cast<int>(std::min<std::int64_t>(kBlockSide, source.width_px - first_col)),
            static_cast<int>(std::min<std::int64_t>(kBlockSide, source.height_px - first_row))};
  }

  /// Which blocks are looked through for voids.
  std::vector<std::pair<std::int64_t, std::int64_t>> blocks_to_look_at(std::span<const GeodeticPoint> around) const {
    const std::int64_t columns = (source.width_px + kBlockSide - 1) / kBlockSide;
    const std::int64_t rows = (source.height_px + kBlockSide - 1) / kBlockSide;
    std::int64_t first_col = 0;
    std::int64_t last_col = columns - 1;
    std::int64_t first_row = 0;
    std::int64_t last_row = rows - 1;
    if (columns * rows > kBlocksOfWhole) {
      std::swap(first_col, last_col);
      std::swap(first_row, last_row);
      for (const GeodeticPoint& point : around) {
        const auto map = map_of(point);
        if (!map) continue;
        const Eigen::Vector2d block = info.map_from_pixel.pixel_from_map(*map) / kBlockSide;
        const auto col = static_cast<std::int64_t>(std::clamp(block.x(), 0.0, static_cast<double>(columns - 1)));
        const auto row = static_cast<std::int64_t>(std::clamp(block.y(), 0.0, static_cast<double>(rows - 1)));
        first_col = std::min(first_col, col);
        last_col = std::max(last_col, col);
        first_row = std::min(first_row, row);
        last_row = std::max(last_row, row);
      }
    }
    std::vector<std::pair<std::int64_t, std::int64_t>> chosen;
    if (last_col < first_col) return chosen;  // around nothing
    const std::int64_t all = (last_col - first_col + 1) * (last_row - first_row + 1);
    const std::int64_t step = std::max<std::int64_t>(1, (all + kBlocksAround - 1) / kBlocksAround);
    for (std::int64_t i = 0; i < all; i += step) {
      chosen.emplace_back(first_col + i % (last_col - first_col + 1), first_row + i / (last_col - first_col + 1));
    }
    return chosen;
  }

  /// In the raster's CRS.
  std::optional<Eigen::Vector2d> map_of(GeodeticPoint point) const {
    auto map = map_from_geodetic.map_from_geodetic(point);
    if (map && in_degrees) map->x() = unwrap_lon_deg(map->x(), center_x);  // grids across 180°
    return map;
  }

  const Block& block_of(std::int64_t col, std::int64_t row) {
    const auto found = std::find_if(blocks.begin(), blocks.end(),
                                    [&](const Block& block) { return block.col == col && block.row == row; });
    if (found != blocks.end()) {
      blocks.splice(blocks.begin(), blocks, found);
      return blocks.front();
    }
    blocks.push_front({col, row, source.read(block_window(col, row))});
    if (blocks.size() > kBlocksKept) blocks.pop_back();
    return blocks.front();
  }

  /// Bilinear between pixel centres at +0.5; what has no weight is not looked at.
  double interpolate(const Eigen::Vector2d& pixel) {
    const auto width = static_cast<double>(source.width_px);
    const auto height = static_cast<double>(source.height_px);
    if (!(pixel.x() >= 0 && pixel.x() <= width && pixel.y() >= 0 && pixel.y() <= height)) return kNaN;
    const double x = std::clamp(pixel.x() - 0.5, 0.0, width - 1);
    const double y = std::clamp(pixel.y() - 0.5, 0.0, height - 1);
    const auto col = static_cast<std::int64_t>(x);
    const auto row = static_cast<std::int64_t>(y);
    const double right = x - static_cast<double>(col);
    const double down = y - static_cast<double>(row);
    const std::array<double, 4> weights{(1 - right) * (1 - down), right * (1 - down), (1 - right) * down, right * down};
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
      const double weight = weights[static_cast<std::size_t>(i)];
      if (weight > 0) sum += weight * stored(col + i % 2, row + i / 2);
    }
    return sum;
  }
};

Elevation::Elevation(const std::string& dataset, const std::string& crs)
    : impl_(std::make_unique<Impl>(dataset, crs)) {}
Elevation::~Elevation() = default;
Elevation::Elevation(Elevation&&) noexcept = default;
Elevation& Elevation::operator=(Elevation&&) noexcept = default;

double Elevation::amsl_m(GeodeticPoint point) const {
  const auto map = impl_->map_of(point);
  if (!map) return kNaN;
  const double height =
      impl_->interpolate(impl_->info.map_from_pixel.pixel_from_map(*map)) * impl_->info.scale + impl_->info.offset;
  if (!impl_->height_transform || std::isnan(height)) return height * impl_->metres_per_unit;
  return impl_->height_transform->amsl_m(*map, height).value_or(kNaN);
}

const std::string& Elevation::dataset() const {
  return impl_->info.dataset;
}
const std::string& Elevation::vertical_datum() const {
  return impl_->vertical_datum;
}
bool Elevation::datum_assumed() const {
  return impl_->datum_assumed;
}

std::vector<UndeclaredVoid> Elevation::undeclared_voids(std::span<const GeodeticPoint> around) const {
  const CrsTransform& geodetic = impl_->map_from_geodetic;
  std::map<double, VoidCount> counts;
  std::int64_t looked_at = 0;
  for (const auto& [col, row] : impl_->blocks_to_look_at(around)) {
    const PixelWindow window = impl_->block_window(col, row);
    const Raster raster = impl_->source.read(window);
    for (int y = 0; y < window.height; ++y) {
      for (int x = 0; x < window.width; ++x) {
        const double value = Impl::value_of(raster, x, y);
        if (std::isnan(value)) continue;
        ++looked_at;
        const double metres = impl_->metres_of(value);
        const bool certain = is_no_height(value, metres);
        if (!certain && !may_be_no_height(value)) continue;
        VoidCount& count = counts[value];
        if (count.pixels++ == 0) {
          count.certain = certain;
          const auto place = geodetic.geodetic_from_map(impl_->info.map_from_pixel.map_from_pixel(
              {static_cast<double>(window.col + x) + 0.5, static_cast<double>(window.row + y) + 0.5}));
          if (place) count.first = *place;
        }
        for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
          const bool inside = x + dx >= 0 && x + dx < window.width && y + dy >= 0 && y + dy < window.height;
          const double beside = inside ? Impl::value_of(raster, x + dx, y + dy) : kNaN;
          if (std::isnan(beside) || beside == value || is_no_height(beside, impl_->metres_of(beside))) continue;
          ++(std::abs(impl_->metres_of(beside) - metres) > kCliff_m ? count.cliffs : count.slopes);
        }
      }
    }
  }
  std::vector<UndeclaredVoid> voids;
  for (const auto& [value, count] : counts) {
    if (!count.certain && !(count.cliffs > count.slopes && count.cliffs >= 4)) continue;
    voids.push_back({value, count.certain, count.pixels, looked_at, count.first});
  }
  return voids;
}

std::string undeclared_void_text(const std::string& dataset, const UndeclaredVoid& found) {
  const std::string value = format_number(found.stored);
  const double percent = 100.0 * static_cast<double>(found.pixels) / static_cast<double>(found.looked_at);
  return dataset + ": " + std::to_string(found.pixels) + " of " + std::to_string(found.looked_at) + " heights (" +
         format_fixed(percent, 1) + " %) are " + value + ", as at lat " + format_fixed(found.first.lat_deg, 6) +
         ", lon " + format_fixed(found.first.lon_deg, 6) +
         (found.certain ? ", which no ground has, and are taken for no height"
                        : ", with a step of more than 20 m to most of those beside them: they may stand for no height, "
                          "and are taken for ground") +
         "; if they are none, declare it: gdal_translate -a_nodata " + value;
}

double Elevation::resolution_m() const {
  return std::max(impl_->info.gsd_x_m, impl_->info.gsd_y_m);
}

void refuse_imagery_as_elevation(const std::string& elevation, const std::vector<std::string>& imagery) {
  if (elevation.empty()) return;
  if (std::find(imagery.begin(), imagery.end(), elevation) != imagery.end()) {
    throw UsageError("elevation = " + elevation + " is the imagery, too; an elevation model holds heights");
  }
  const ImageryInfo info = inspect_imagery(elevation, height_options(""));
  if (info.band_colors.size() < 3 && !info.palette) return;
  throw DataError(elevation + ": has " + std::to_string(info.band_colors.size()) +
                  " band(s) of colours; it looks like imagery, not like an elevation model, which has one of heights");
}

}  // namespace pilotage
