#include "pilotage/raster/elevation.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {
namespace {

constexpr int kBlockSide = 256;
constexpr std::size_t kBlocksKept = 32;  // 32 × 256² doubles and masks: 19 MB

/// The name of a unit in small letters and figures, a blank for everything else: "US_survey_foot" is "us survey foot".
std::string plain_unit(const std::string& unit) {
  std::string plain;
  for (const char c : unit) {
    const auto letter = static_cast<unsigned char>(c);
    const bool kept = std::isalnum(letter) != 0;
    if (kept) plain += static_cast<char>(std::tolower(letter));
    if (!kept && !plain.empty() && plain.back() != ' ') plain += ' ';
  }
  if (plain.ends_with(' ')) plain.pop_back();
  return plain;
}

/// A unit of height, metres in it (EPSG's figures), and how it is spelt by those who write rasters.
struct HeightUnit {
  double metres;
  std::vector<std::string_view> names;
};

const std::vector<HeightUnit>& height_units() {
  static const std::vector<HeightUnit> units = {
      {1, {"", "m", "metre", "meter", "metres", "meters"}},
      {0.3048,
       {"ft", "foot", "feet", "foot international", "feet international", "ft international", "international foot",
        "international feet", "intl foot", "intl feet", "intl ft", "foot intl", "feet intl", "ft intl"}},
      {1200.0 / 3937.0, {"us ft",           "usft",           "ft us",           "ftus",
                         "us foot",         "us feet",        "foot us",         "feet us",
                         "us survey foot",  "us survey feet", "us survey ft",    "survey foot",
                         "survey feet",     "survey ft",      "foot us survey",  "feet us survey",
                         "ft us survey",    "ussurveyfoot",   "u s survey foot", "u s survey feet",
                         "foot u s survey", "foot u s",       "feet u s",        "u s foot",
                         "u s feet",        "foot survey us"}},
      {0.3047972654, {"clarke s foot", "clarke foot", "foot clarke", "clarke s feet"}},
      {0.304799514, {"indian foot", "indian feet", "ind ft", "foot indian"}},
      {0.304799472, {"british foot sears 1922", "british foot", "foot british"}},
      {0.9144, {"yd", "yard", "yards"}},
      {0.1, {"dm", "decimetre", "decimeter", "decimetres", "decimeters"}},
      {0.01, {"cm", "centimetre", "centimeter", "centimetres", "centimeters"}},
      {0.001, {"mm", "millimetre", "millimeter", "millimetres", "millimeters"}},
      {1000, {"km", "kilometre", "kilometer", "kilometres", "kilometers"}}};
  return units;
}

/// Metres per unit of a band's unit as GDAL gives it; nothing when it is not known.
std::optional<double> metres_of(const std::string& unit) {
  const std::string plain = plain_unit(unit);
  for (const HeightUnit& known : height_units()) {
    if (std::find(known.names.begin(), known.names.end(), plain) != known.names.end()) return known.metres;
  }
  return std::nullopt;
}

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
    const std::optional<double> metres = metres_of(info.unit);
    if (!metres) {
      throw DataError(
          info.dataset + ": its heights are in \"" + info.unit.substr(0, 40) +
          "\", a unit that is not known; known are metre, foot, US survey foot, Clarke's, Indian and British "
          "foot, yard, dm, cm, mm and km: say it with gdal_edit.py -units m");
    }
    metres_per_unit = *metres;
    vertical_datum = "assumed to be metres above mean sea level";
    if (*metres != 1) vertical_datum = "assumed to be above mean sea level, in " + info.unit;
    if (info.crs.has_height()) {
      vertical_datum += " (PROJ has no grid here to transform the heights of \"" + info.crs.name() + "\")";
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
    if (block.raster.valid.at<std::uint8_t>(y, x) == 0) return kNaN;
    const cv::Mat& pixels = block.raster.pixels;
    switch (pixels.depth()) {
      case CV_8U:
        return pixels.at<std::uint8_t>(y, x);
      case CV_16U:
        return pixels.at<std::uint16_t>(y, x);
      default:
        return pixels.at<double>(y, x);
    }
  }

  const Block& block_of(std::int64_t col, std::int64_t row) {
    const auto found = std::find_if(blocks.begin(), blocks.end(),
                                    [&](const Block& block) { return block.col == col && block.row == row; });
    if (found != blocks.end()) {
      blocks.splice(blocks.begin(), blocks, found);
      return blocks.front();
    }
    const std::int64_t first_col = col * kBlockSide;
    const std::int64_t first_row = row * kBlockSide;
    const auto width = static_cast<int>(std::min<std::int64_t>(kBlockSide, source.width_px - first_col));
    const auto height = static_cast<int>(std::min<std::int64_t>(kBlockSide, source.height_px - first_row));
    blocks.push_front({col, row, source.read({first_col, first_row, width, height})});
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
  auto map = impl_->map_from_geodetic.map_from_geodetic(point);
  if (!map) return kNaN;
  if (impl_->in_degrees) map->x() = unwrap_lon_deg(map->x(), impl_->center_x);  // grids across 180°
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
