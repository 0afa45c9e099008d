#include "pilotage/landmark/label_landmarks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

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
constexpr int kMostChip_px = 4096;
constexpr int kDrawsPerBackgroundChip = 200;

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
    double finest_m = std::numeric_limits<double>::infinity();
    for (const ImageryInfo& info : infos) finest_m = std::min(finest_m, std::max(info.gsd_x_m, info.gsd_y_m));
    grid.gsd_m = finest_m;
  }
  grid.tile_size_px = 2;  // no tiles are cut
  return {ground_of_inspected(infos, grid), imagery_warnings(infos, 0)};
}

/// The dates of the imagery, "" where it has none.
struct ImageryDates {
  std::string first;
  std::string last;
};

ImageryDates dates_of(const Ground& ground) {
  ImageryDates dates;
  for (const ImageryDataset& dataset : ground.imagery.datasets) {
    const std::string day = dataset.acquired.substr(0, 10);
    if (day.empty()) continue;
    if (dates.first.empty() || day < dates.first) dates.first = day;
    if (day > dates.last) dates.last = day;
  }
  return dates;
}

bool is_date(const std::string& text) {
  return text.size() >= 4 &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || c == '-'; });
}

/// Why a landmark cannot be seen on imagery of these dates, or "". A day is compared with a year as a year.
std::string date_misfit(const LandmarkLabel& label, const ImageryDates& dates) {
  if (dates.first.empty()) return "";
  if (is_date(label.start_date) && label.start_date > dates.last.substr(0, label.start_date.size())) {
    return "begins " + label.start_date + ", after the imagery of " + dates.last;
  }
  if (is_date(label.end_date) && label.end_date < dates.first.substr(0, label.end_date.size())) {
    return "ended " + label.end_date + ", before the imagery of " + dates.first;
  }
  return "";
}

/// A label on the pixels of the grid.
struct GridLabel {
  LandmarkLabel label;
  OrientedBox box_m;
  std::vector<Vector2d> outline_px;
  PixelWindow bounds_px;  ///< Around the outline; may leave the grid.
  PixelWindow chip_px;
};

PixelWindow window_around(const std::vector<Vector2d>& outline) {
  Bounds bounds;
  for (const Vector2d& point : outline) bounds.extend(point);
  const auto col = static_cast<std::int64_t>(std::floor(bounds.min_x_m));
  const auto row = static_cast<std::int64_t>(std::floor(bounds.min_y_m));
  return {col, row, static_cast<int>(std::ceil(bounds.max_x_m) - static_cast<double>(col)),
          static_cast<int>(std::ceil(bounds.max_y_m) - static_cast<double>(row))};
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
  placed.bounds_px = window_around(placed.outline_px);
  constexpr double kRounding_px = 0.01;  // coordinates in degrees have seven decimals in some formats
  const double side_px = std::ceil(kChipLengths * placed.box_m.length / level.gsd_m - kRounding_px);
  if (side_px > kMostChip_px) {
    throw DataError(label.name + ": is " + format_fixed(placed.box_m.length, 1) + " m long; its chip would be " +
                    format_number(side_px) + " px wide, more than " + std::to_string(kMostChip_px) +
                    "; take a larger --gsd-m");
  }
  const Vector2d middle_px = level.matrix.map_from_pixel.pixel_from_map(placed.box_m.center);
  placed.chip_px = chip_around(middle_px, std::max(static_cast<int>(side_px), kLeastChip_px), level.matrix);
  placed.label = std::move(label);
  return placed;
}

bool intersect(const PixelWindow& a, const PixelWindow& b) {
  return a.col < b.col + b.width && b.col < a.col + a.width && a.row < b.row + b.height && b.row < a.row + a.height;
}

bool contains(const PixelWindow& outer, const PixelWindow& inner) {
  return inner.col >= outer.col && inner.row >= outer.row && inner.col + inner.width <= outer.col + outer.width &&
         inner.row + inner.height <= outer.row + outer.height;
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
    const bool chip = (name.starts_with(kChipStem) || name.starts_with(kBackgroundStem)) &&
                      (name.ends_with(".png") || name.ends_with(".png.aux.xml"));
    if (chip || name == kChipAnnotations || name == kLabelShapes) names.push_back(name);
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
                   {"chip", VectorType::kText, ""},
                   {"source", VectorType::kText, ""}};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const GridLabel& placed = labels[i];
    VectorFeature feature;
    feature.points = placed.label.outline_m;
    feature.values = {placed.label.class_name, placed.box_m.length, placed.box_m.width, heading_deg(placed.box_m),
                      placed.label.box_alone,  placed.label.ignore, chips[i],           placed.label.name};
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

void write_background(const std::vector<GridLabel>& labels, const TileMatrix& grid, std::int64_t wanted,
                      std::uint64_t seed, ChipWriter& writer, LabelledChips& result,
                      std::vector<AnnotatedPicture>& pictures, const Progress& progress) {
  std::vector<double> sides;
  for (const GridLabel& placed : labels) sides.push_back(placed.chip_px.width);
  const int side_px = static_cast<int>(quantile(sides, 0.5));
  const auto width = static_cast<int>(std::min<std::int64_t>(side_px, grid.grid_width_px));
  const auto height = static_cast<int>(std::min<std::int64_t>(side_px, grid.grid_height_px));
  Random random(seed);
  for (std::int64_t draw = 0; draw < wanted * kDrawsPerBackgroundChip && result.background_chips < wanted; ++draw) {
    const PixelWindow window{
        static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(grid.grid_width_px - width + 1))),
        static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(grid.grid_height_px - height + 1))), width,
        height};
    const bool labelled = std::any_of(labels.begin(), labels.end(),
                                      [&](const GridLabel& placed) { return intersect(placed.bounds_px, window); });
    if (labelled) continue;
    Raster chip = writer.read(window);
    if (cv::countNonZero(chip.valid) < width * height) continue;
    const std::string name = numbered(kBackgroundStem, static_cast<std::size_t>(++result.background_chips));
    writer.write(std::move(chip), window, name);
    pictures.push_back({name, {}});
    report_progress(progress, "background chips", result.background_chips, wanted);
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
  const ImageryDates dates = dates_of(on.ground);
  const bool refuse = options.unfit == UnfitLabels::kRefuse;

  std::vector<GridLabel> labels;
  for (LandmarkLabel& label : read_landmark_labels(options, on.ground.crs, result.merged)) {
    const std::string misfit = date_misfit(label, dates);
    if (!misfit.empty() && refuse) throw DataError(label.name + ": " + misfit + "; --unfit skip leaves it out");
    if (!misfit.empty()) {
      ++result.other_date;
      continue;
    }
    labels.push_back(on_grid(std::move(label), level));
  }

  const StagingFolder staging(folder);
  ChipWriter writer(staging, source, result);
  std::vector<AnnotatedPicture> pictures;
  std::vector<std::string> chips;  // of `kept`; "" of what is ignored
  std::vector<GridLabel> kept;
  const PixelWindow all{0, 0, static_cast<int>(grid.grid_width_px), static_cast<int>(grid.grid_height_px)};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    report_progress(progress, "chips", static_cast<std::int64_t>(i), std::ssize(labels));
    const GridLabel& placed = labels[i];
    if (placed.label.ignore) {
      chips.emplace_back();
      kept.push_back(placed);
      continue;
    }
    std::optional<Raster> chip;
    if (contains(all, placed.bounds_px)) {
      Raster read = writer.read(placed.chip_px);
      if (shows_all(read, placed.outline_px, placed.chip_px)) chip = std::move(read);
    }
    if (!chip) {
      if (refuse) {
        throw DataError(placed.label.name +
                        ": does not lie wholly on ground that the imagery shows; --unfit skip leaves such labels out");
      }
      ++result.outside;
      continue;
    }
    const std::string name = numbered(kChipStem, pictures.size() + 1);
    writer.write(std::move(*chip), placed.chip_px, name);
    AnnotatedPicture& picture = pictures.emplace_back();
    picture.picture = name;
    picture.labels.push_back(label_on_chip(placed, placed.chip_px, true));
    for (std::size_t other = 0; other < labels.size(); ++other) {
      if (other == i || !intersect(labels[other].bounds_px, placed.chip_px)) continue;
      picture.labels.push_back(label_on_chip(labels[other], placed.chip_px, false));
    }
    chips.push_back(name);
    kept.push_back(placed);
  }
  if (pictures.empty()) throw DataError(join(options.labels, ", ") + ": no label fits the imagery");
  const std::int64_t wanted = options.background_chips.value_or(static_cast<int>(pictures.size()));
  write_background(labels, grid, wanted, seed, writer, result, pictures, progress);
  if (result.background_chips < wanted) {
    result.warnings.push_back("only " + std::to_string(result.background_chips) + " of " + std::to_string(wanted) +
                              " background chips were found: there is little ground without labels");
  }
  write_file(staging / kChipAnnotations, imglab_xml(pictures, "Labelled landmarks"), false);
  write_geojson(staging / kLabelShapes, label_layer(kept, chips, on.ground.crs), false);
  result.files.insert(result.files.begin(), {kChipAnnotations, kLabelShapes});
  result.classes = classes_of(kept);
  staging.publish(result.files, earlier);
  return result;
}

}  // namespace pilotage
