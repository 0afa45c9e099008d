#include "pilotage/landmark/label_landmarks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <regex>
#include <set>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/landmark/annotated_picture.h"
#include "pilotage/landmark/landmark_label.h"
#include "pilotage/landmark/outline.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/raster/gdal_png.h"
#include "pilotage/raster/gdal_vector.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

/// A chip is so many lengths of its label wide: a square of 2.2 lengths can be cut from it at any heading.
constexpr double kChipLengths = 3.2;
constexpr int kLeastChip_px = 64;
/// What is narrower is no outline, but a line or a point.
constexpr double kLeastWidth_px = 1;
constexpr int kMostChip_px = 4096;
constexpr int kDrawsInVain = 1000;

/// Of what rasters are no grid of square, north-up pixels in metres.
bool is_metric_grid(const ImageryInfo& info) {
  constexpr double kSquare = 1e-6;
  const GeoTransform& place = info.map_from_pixel;
  const bool north_up = place.x_per_row == 0 && place.y_per_col == 0 && place.x_per_col > 0 && place.y_per_row < 0;
  const bool square = std::abs(place.x_per_col + place.y_per_row) <= kSquare * place.x_per_col;
  constexpr double kMostStretch = 0.005;  // as of a mission's grid (raster/mission_crs.h)
  return north_up && square && info.crs.is_projected() && info.crs.metres_per_unit() == 1.0 &&
         std::abs(info.gsd_x_m / place.x_per_col - 1) <= kMostStretch;
}

struct ChipGround {
  Ground ground;
  std::vector<std::string> warnings;
};

ChipGround chip_ground(const std::vector<std::string>& inputs, const LabelOptions& options, const Progress& progress) {
  RasterGridOptions grid;
  grid.imagery = options.imagery;
  grid.gsd_m = options.gsd_m;
  grid.crs = options.crs;
  if (inputs.size() == 1 && inputs.front().ends_with(".json")) {
    refuse_raster_grid(grid, inputs.front());
    return {read_plan(inputs.front()).ground, {}};
  }
  std::vector<ImageryInfo> infos;
  for (const std::string& dataset : inputs) infos.push_back(inspect_imagery(dataset, options.imagery, progress));
  if (!grid.gsd_m && (infos.size() > 1 || !options.crs.empty() || !is_metric_grid(infos.front()))) {
    // Parts of one grid keep its pixels, which are not quite as long on the ground as on the map.
    double finest_m = std::numeric_limits<double>::infinity();
    for (const ImageryInfo& info : infos) {
      finest_m = std::min(finest_m,
                          is_metric_grid(info) ? info.map_from_pixel.x_per_col : std::max(info.gsd_x_m, info.gsd_y_m));
    }
    grid.gsd_m = finest_m;
  }
  grid.tile_size_px = 2;  // no tiles are cut
  return {ground_of_inspected(infos, grid), imagery_warnings(infos, 0)};
}

/// A label on the pixels of the grid.
struct GridLabel {
  LandmarkLabel label;
  OrientedBox box_m;
  std::vector<Vector2d> outline_px;
  Bounds bounds_px;  ///< Around the outline, in pixels of the grid, which it may leave.
};

/// The pixels that an outline lies on. A hundredth of one is rounding: coordinates in degrees have seven decimals in
/// some formats.
constexpr double kRounding_px = 0.01;

Bounds bounds_of_outline(const std::vector<Vector2d>& outline) {
  Bounds bounds;
  for (const Vector2d& point : outline) bounds.extend(point);
  return bounds.grown(-kRounding_px);
}

bool lies_on(const Bounds& bounds_px, const TileMatrix& grid) {
  return bounds_px.min_x_m >= 0 && bounds_px.min_y_m >= 0 &&
         bounds_px.max_x_m <= static_cast<double>(grid.grid_width_px) &&
         bounds_px.max_y_m <= static_cast<double>(grid.grid_height_px);
}

/// The first of `count` pixels of an axis that is `extent` long and that lie as near as may be around `middle`.
std::int64_t placed_along(double middle, int count, std::int64_t extent) {
  return std::clamp<std::int64_t>(std::llround(middle - count / 2.0), 0, extent - count);
}

PixelWindow chip_around(const Vector2d& middle_px, int side_px, const TileMatrix& grid) {
  const auto width = static_cast<int>(std::min<std::int64_t>(side_px, grid.grid_width_px));
  const auto height = static_cast<int>(std::min<std::int64_t>(side_px, grid.grid_height_px));
  return {placed_along(middle_px.x(), width, grid.grid_width_px),
          placed_along(middle_px.y(), height, grid.grid_height_px), width, height};
}

GridLabel on_grid(LandmarkLabel label, const GridLevel& level) {
  GridLabel placed;
  placed.box_m = oriented_box(label.outline_m);
  for (const Vector2d& corner : label.outline_m) {
    placed.outline_px.push_back(level.matrix.map_from_pixel.pixel_from_map(corner));
  }
  placed.bounds_px = bounds_of_outline(placed.outline_px);
  placed.label = std::move(label);
  return placed;
}

/// The chip of a label that lies on the grid. Throws DataError when it would be too large.
PixelWindow chip_of(const GridLabel& placed, const GridLevel& level) {
  const double side_px = std::round(kChipLengths * placed.box_m.length / level.matrix.map_from_pixel.x_per_col);
  if (side_px > kMostChip_px) {
    throw DataError(placed.label.name + ": is " + format_fixed(placed.box_m.length, 1) + " m long; its chip would be " +
                    format_number(side_px) + " px wide, more than " + std::to_string(kMostChip_px) +
                    "; take a larger --gsd-m");
  }
  const Vector2d middle_px = level.matrix.map_from_pixel.pixel_from_map(placed.box_m.center);
  return chip_around(middle_px, std::max(static_cast<int>(side_px), kLeastChip_px), level.matrix);
}

bool intersect(const Bounds& bounds_px, const PixelWindow& window) {
  const auto col = static_cast<double>(window.col);
  const auto row = static_cast<double>(window.row);
  return bounds_px.intersects({col, row, col + window.width, row + window.height});
}

std::vector<cv::Point> polygon_of(const std::vector<Vector2d>& outline_px, const PixelWindow& window) {
  std::vector<cv::Point> polygon;
  for (const Vector2d& corner : outline_px) {
    polygon.emplace_back(static_cast<int>(std::floor(corner.x() - static_cast<double>(window.col))),
                         static_cast<int>(std::floor(corner.y() - static_cast<double>(window.row))));
  }
  return polygon;
}

/// Whether all ground within an outline is valid on a chip that holds it.
bool shows_all(const Raster& chip, const std::vector<Vector2d>& outline_px, const PixelWindow& window) {
  cv::Mat inside(chip.valid.size(), CV_8U, cv::Scalar(0));
  cv::fillPoly(inside, std::vector<std::vector<cv::Point>>{polygon_of(outline_px, window)}, cv::Scalar(255));
  // Pixels under the outline itself belong to both sides; on the chip's edge there is only one.
  cv::erode(inside, inside, cv::Mat::ones(3, 3, CV_8U));
  return cv::countNonZero(inside & ~chip.valid) == 0;
}

/// What is no ground becomes as gray as the rest on average: black would be an edge.
void fill_invalid(Raster& chip) {
  if (cv::countNonZero(chip.valid) == 0) return;
  const cv::Scalar mean = cv::mean(chip.pixels, chip.valid);
  chip.pixels.setTo(mean, ~chip.valid);
}

std::string numbered(const char* stem, std::size_t number) {
  const std::string digits = std::to_string(number);
  return stem + std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits + ".png";
}

constexpr const char* kChipStem = "chip_";
constexpr const char* kBackgroundStem = "background_";

std::vector<std::string> earlier_chips(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    static const std::regex kChip("(chip|background)_[0-9]{6,}\\.png(\\.aux\\.xml)?");  // as numbered() makes them
    if (std::regex_match(name, kChip) || name == kChipAnnotations || name == kLabelShapes) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

PictureLabel label_on_chip(const GridLabel& placed, const PixelWindow& chip, bool own) {
  PictureLabel label;
  label.class_name = placed.label.class_name;
  label.box_alone = placed.label.box_alone;
  label.ignore = placed.label.ignore || !own;
  for (const Vector2d& corner : placed.outline_px) {
    label.outline_px.emplace_back(corner.x() - static_cast<double>(chip.col),
                                  corner.y() - static_cast<double>(chip.row));
  }
  return label;
}

double heading_deg(const OrientedBox& box) {
  const double heading = 90 - box.angle_rad * 180 / std::numbers::pi;
  return heading < 0 ? heading + 180 : heading;
}

VectorLayer label_layer(const std::vector<GridLabel>& labels, const std::vector<std::string>& chips, const Crs& crs) {
  VectorLayer layer;
  layer.name = "labels";
  layer.title = "Labelled landmarks";
  layer.shape = VectorShape::kPolygon;
  layer.crs = crs;
  layer.columns = {{"class", VectorType::kText, ""},
                   {"length_m", VectorType::kReal, "Length, m"},
                   {"width_m", VectorType::kReal, "Width, m"},
                   {"heading_deg", VectorType::kReal, "Heading of the longer side, degrees clockwise from grid north"},
                   {"box_alone", VectorType::kBoolean, "Neither form nor heading known"},
                   {"ignore", VectorType::kBoolean, "Neither to be found nor missed"},
                   {"start_date", VectorType::kText, ""},
                   {"end_date", VectorType::kText, ""},
                   {"chip", VectorType::kText, ""},
                   {"source", VectorType::kText, ""}};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const GridLabel& placed = labels[i];
    VectorFeature feature;
    feature.points = placed.label.outline_m;
    const auto text_or_null = [](const std::string& text) -> VectorValue {
      if (text.empty()) return std::monostate{};
      return text;
    };
    feature.values = {placed.label.class_name,
                      placed.box_m.length,
                      placed.box_m.width,
                      heading_deg(placed.box_m),
                      placed.label.box_alone,
                      placed.label.ignore,
                      text_or_null(placed.label.start_date),
                      text_or_null(placed.label.end_date),
                      text_or_null(chips[i]),
                      placed.label.name};
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

std::vector<LabelledClass> classes_of(const std::vector<GridLabel>& labels) {
  std::map<std::string, std::vector<double>> lengths;
  for (const GridLabel& placed : labels) {
    if (!placed.label.ignore) lengths[placed.label.class_name].push_back(placed.box_m.length);
  }
  std::vector<LabelledClass> classes;
  for (const auto& [name, lengths_m] : lengths) {
    classes.push_back(
        {name, std::ssize(lengths_m), quantile(lengths_m, 0), quantile(lengths_m, 0.5), quantile(lengths_m, 1)});
  }
  return classes;
}

/// Writes chips into a folder that is published at the end.
class ChipWriter {
 public:
  ChipWriter(const StagingFolder& staging, const GraySource& source, LabelledChips& result)
      : staging_(staging), source_(source), result_(result) {}

  Raster read(const PixelWindow& window) const { return source_.read(window); }

  void write(Raster chip, const PixelWindow& window, const std::string& name) {
    fill_invalid(chip);
    chip.map_from_pixel =
        source_.map_from_pixel.shifted(static_cast<double>(window.col), static_cast<double>(window.row));
    write_gray8_png(staging_ / name, chip, source_.crs);
    result_.files.push_back(name);
    result_.files.push_back(name + ".aux.xml");
  }

 private:
  const StagingFolder& staging_;
  const GraySource& source_;
  LabelledChips& result_;
};

/// Ground without labels, no window twice. Gives up where most of it is no ground or labelled.
void write_background(const std::vector<GridLabel>& labels, const TileMatrix& grid, int side_px, std::int64_t wanted,
                      std::uint64_t seed, ChipWriter& writer, LabelledChips& result,
                      std::vector<AnnotatedPicture>& pictures, const Progress& progress) {
  const auto width = static_cast<int>(std::min<std::int64_t>(side_px, grid.grid_width_px));
  const auto height = static_cast<int>(std::min<std::int64_t>(side_px, grid.grid_height_px));
  Random random(seed);
  std::set<std::pair<std::int64_t, std::int64_t>> taken;
  for (int in_vain = 0; in_vain < kDrawsInVain && result.background_chips < wanted; ++in_vain) {
    report_progress(progress, "background chips", result.background_chips, wanted);
    const PixelWindow window{
        static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(grid.grid_width_px - width + 1))),
        static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(grid.grid_height_px - height + 1))), width,
        height};
    const bool labelled = std::any_of(labels.begin(), labels.end(),
                                      [&](const GridLabel& placed) { return intersect(placed.bounds_px, window); });
    if (labelled || !taken.insert({window.col, window.row}).second) continue;
    Raster chip = writer.read(window);
    if (cv::countNonZero(chip.valid) < width * height) continue;
    const std::string name = numbered(kBackgroundStem, static_cast<std::size_t>(++result.background_chips));
    writer.write(std::move(chip), window, name);
    pictures.emplace_back().picture = name;
    in_vain = 0;
  }
}

}  // namespace

LabelledChips label_landmarks(const std::vector<std::string>& inputs, const LabelOptions& options,
                              const fs::path& folder, bool overwrite, std::uint64_t seed, const Progress& progress) {
  check_options(options);
  const std::vector<std::string> earlier = earlier_chips(folder);
  if (!overwrite && !earlier.empty()) {
    throw DataError((folder / earlier.front()).string() + ": exists already; give --overwrite to replace it");
  }
  const ChipGround on = chip_ground(inputs, options, progress);
  const GridLevel& level = on.ground.levels.front();
  const TileMatrix& grid = level.matrix;
  const GraySource source = stretch_to_8bit(open_gray(on.ground, level));
  LabelledChips result;
  result.crs = on.ground.crs;
  result.gsd_m = level.gsd_m;
  result.warnings = on.warnings;
  ImageryDates dates;
  for (const ImageryDataset& dataset : on.ground.imagery.datasets) dates.add(dataset.acquired);
  const bool refuse = options.unfit == UnfitLabels::kRefuse;

  LandmarkLabels read = read_landmark_labels(options, options.imagery.imagery_crs, on.ground.crs);
  result.merged = read.merged;
  result.warnings.insert(result.warnings.end(), read.warnings.begin(), read.warnings.end());
  const auto misfit = [&](const std::string& why, std::int64_t& count) {
    if (refuse) throw DataError(why + "; --unfit skip leaves such labels out");
    ++count;
  };
  for (const std::string& why : read.nowhere) misfit(why, result.outside);
  std::vector<GridLabel> labels;
  std::int64_t ignored = 0;
  for (LandmarkLabel& label : read.labels) {
    ignored += label.ignore ? 1 : 0;
    const std::string other_date = date_misfit(label, dates);
    if (!other_date.empty()) {
      misfit(label.name + ": " + other_date, result.other_date);
    } else {
      labels.push_back(on_grid(std::move(label), level));
    }
  }

  const StagingFolder staging(folder);
  ChipWriter writer(staging, source, result);
  std::vector<AnnotatedPicture> pictures;
  std::vector<std::string> chips;  // of `kept`; "" of what is ignored
  std::vector<GridLabel> kept;
  std::vector<double> sides_px;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    report_progress(progress, "chips", static_cast<std::int64_t>(i), std::ssize(labels));
    const GridLabel& placed = labels[i];
    if (placed.label.ignore) {
      chips.emplace_back();
      kept.push_back(placed);
      continue;
    }
    if (!lies_on(placed.bounds_px, grid)) {
      misfit(placed.label.name + ": does not lie wholly on ground that the imagery shows", result.outside);
      continue;
    }
    if (placed.box_m.width < kLeastWidth_px * grid.map_from_pixel.x_per_col) {
      throw DataError(placed.label.name + ": is an outline without extent, " + format_fixed(placed.box_m.width, 3) +
                      " m wide on pixels of " + format_fixed(result.gsd_m, 3) + " m");
    }
    const PixelWindow window = chip_of(placed, level);
    Raster chip = writer.read(window);
    if (!shows_all(chip, placed.outline_px, window)) {
      misfit(placed.label.name + ": does not lie wholly on ground that the imagery shows", result.outside);
      continue;
    }
    const std::string name = numbered(kChipStem, pictures.size() + 1);
    writer.write(std::move(chip), window, name);
    AnnotatedPicture& picture = pictures.emplace_back();
    picture.picture = name;
    picture.labels.push_back(label_on_chip(placed, window, true));
    for (std::size_t other = 0; other < labels.size(); ++other) {
      if (other == i || !intersect(labels[other].bounds_px, window)) continue;
      picture.labels.push_back(label_on_chip(labels[other], window, false));
    }
    sides_px.push_back(window.width);
    chips.push_back(name);
    kept.push_back(placed);
  }
  if (pictures.empty()) {
    throw DataError(join(options.labels, ", ") + ": no label fits the imagery: " + std::to_string(result.outside) +
                    " not wholly on ground that it shows, " + std::to_string(result.other_date) + " of another date, " +
                    std::to_string(ignored) + " ignored");
  }
  const std::int64_t wanted = options.background_chips.value_or(static_cast<int>(pictures.size()));
  write_background(labels, grid, static_cast<int>(quantile(sides_px, 0.5)), wanted, seed, writer, result, pictures,
                   progress);
  if (result.background_chips < wanted) {
    result.warnings.push_back("only " + std::to_string(result.background_chips) + " of " + std::to_string(wanted) +
                              " background chips were found: little of the imagery is ground without labels");
  }
  write_file(staging / kChipAnnotations, imglab_xml(pictures, "Labelled landmarks"), false);
  write_geojson(staging / kLabelShapes, label_layer(kept, chips, on.ground.crs), false);
  result.files.insert(result.files.begin(), {kChipAnnotations, kLabelShapes});
  result.classes = classes_of(kept);
  staging.publish(result.files, earlier);
  return result;
}

}  // namespace pilotage
