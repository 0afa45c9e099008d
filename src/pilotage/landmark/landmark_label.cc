#include "pilotage/landmark/landmark_label.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/landmark/annotated_picture.h"
#include "pilotage/landmark/outline.h"
#include "pilotage/route/ogr_shapes.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

/// Two labels that cover so much of the same ground are of one thing.
constexpr double kSameThing = 0.7;

std::string property(const GeodeticShape& shape, const std::string& key) {
  const auto found = shape.properties.find(key);
  return found == shape.properties.end() ? "" : found->second;
}

/// The class of a shape, or "" when it is no label.
std::string class_of(const GeodeticShape& shape, const LabelSourceOptions& options) {
  return options.class_name.empty() ? property(shape, options.class_field) : options.class_name;
}

bool is_wanted(const std::string& class_name, const LabelSourceOptions& options) {
  if (class_name.empty()) return false;
  return options.classes.empty() ||
         std::find(options.classes.begin(), options.classes.end(), class_name) != options.classes.end();
}

std::vector<Vector2d> placed(const std::vector<GeodeticPoint>& points, const CrsTransform& transform,
                             const std::string& name, const Crs& crs) {
  std::vector<Vector2d> placed;
  for (const GeodeticPoint& point : points) {
    const auto on_map = transform.map_from_geodetic(point);
    if (!on_map) {
      throw DataError(name + ": its corner " + format_number(point.lon_deg) + ", " + format_number(point.lat_deg) +
                      " has no image in " + crs.name());
    }
    placed.push_back(*on_map);
  }
  return placed;
}

std::vector<Vector2d> outline_of(const GeodeticShape& shape, const LabelSourceOptions& options,
                                 const CrsTransform& transform, const Crs& crs) {
  std::vector<Vector2d> outline = placed(shape.rings.front(), transform, shape.name, crs);
  if (shape.kind == ShapeKind::kPoint) {
    const std::string text = property(shape, "diameter");
    std::optional<double> diameter_m = text.empty() ? options.diameter_m : parse_number(text);
    if (!text.empty() && !(diameter_m && std::isfinite(*diameter_m) && *diameter_m > 0)) {
      throw DataError(shape.name + ": its diameter \"" + text + "\" is no number of metres above 0");
    }
    if (!diameter_m) throw DataError(shape.name + ": is a point, and nobody says its size; give --diameter-m");
    return circle_outline(outline.front(), *diameter_m);
  }
  if (shape.kind == ShapeKind::kLine) {
    const bool closed = outline.size() > 3 && (outline.front() - outline.back()).norm() < 1e-6;
    if (!closed) throw DataError(shape.name + ": is an open line; a landmark is a polygon, a closed line or a point");
    outline.pop_back();
  }
  return outline;
}

void add_shapes(const std::string& file, const LabelSourceOptions& options, const Crs& crs,
                std::vector<LandmarkLabel>& labels) {
  const CrsTransform transform(crs);
  std::set<std::string> fields;
  bool any = false;
  for (const GeodeticShape& shape : read_shapes(file)) {
    for (const auto& [key, value] : shape.properties) fields.insert(key);
    const std::string class_name = class_of(shape, options);
    any = any || !class_name.empty();
    if (!is_wanted(class_name, options)) continue;
    // The two flags are those of labels.geojson of an earlier run.
    labels.push_back({class_name, outline_of(shape, options, transform, crs), property(shape, "box_alone") == "1",
                      property(shape, "ignore") == "1", property(shape, "start_date"), property(shape, "end_date"),
                      shape.name});
  }
  if (any) return;
  const std::vector<std::string> known(fields.begin(), fields.end());
  throw DataError(file + ": no shape has a property " + options.class_field +
                  "; give --class, or --class-field with one of: " + (known.empty() ? "(none)" : join(known, ", ")));
}

void add_annotations(const std::string& file, const LabelSourceOptions& options, const Crs& crs,
                     std::vector<LandmarkLabel>& labels) {
  const CrsTransform transform(crs);
  for (const AnnotatedPicture& picture : read_annotations(file, options.class_names)) {
    if (picture.labels.empty()) continue;
    const ImageryInfo info = [&] {
      try {
        return inspect_imagery(picture.picture.string());
      } catch (const DataError& error) {
        throw DataError(picture.labels.front().name + ": its picture has no place on the ground: " + error.what());
      }
    }();
    const CrsTransform of_picture(info.crs);
    for (const PictureLabel& label : picture.labels) {
      const std::string class_name = options.class_name.empty() ? label.class_name : options.class_name;
      if (!is_wanted(class_name, options)) continue;
      std::vector<GeodeticPoint> corners;
      for (const Vector2d& corner_px : label.outline_px) {
        const auto corner = of_picture.geodetic_from_map(info.map_from_pixel.map_from_pixel(corner_px));
        if (!corner) throw DataError(label.name + ": a corner lies nowhere on the ground");
        corners.push_back(*corner);
      }
      labels.push_back(
          {class_name, placed(corners, transform, label.name, crs), label.box_alone, label.ignore, "", "", label.name});
    }
  }
}

/// Labels by squares of the ground, so that each is compared with its neighbours alone.
std::vector<LandmarkLabel> without_twins(std::vector<LandmarkLabel> labels, int& merged) {
  double cell_m = 1;
  for (const LandmarkLabel& label : labels) cell_m = std::max(cell_m, oriented_box(label.outline_m).length);
  using Cell = std::pair<std::int64_t, std::int64_t>;
  std::map<Cell, std::vector<std::size_t>> cells;
  std::vector<LandmarkLabel> kept;
  merged = 0;
  for (LandmarkLabel& label : labels) {
    const Vector2d middle = oriented_box(label.outline_m).center / cell_m;
    const Cell cell{std::llround(middle.x()), std::llround(middle.y())};
    bool twin = false;
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto found = cells.find({cell.first + dx, cell.second + dy});
        if (found == cells.end()) continue;
        for (const std::size_t other : found->second) {
          if (bounds_overlap(kept[other].outline_m, label.outline_m) <= kSameThing) continue;
          if (kept[other].class_name != label.class_name) {
            throw DataError(label.name + ": is a " + label.class_name + " where " + kept[other].name +
                            " has labelled a " + kept[other].class_name);
          }
          twin = true;
          // On chips of an earlier run a landmark is ignored beside another one, and counts on its own.
          if (kept[other].ignore && !label.ignore) kept[other] = label;
        }
      }
    }
    if (twin) {
      ++merged;
      continue;
    }
    cells[cell].push_back(kept.size());
    kept.push_back(std::move(label));
  }
  return kept;
}

}  // namespace

std::vector<LandmarkLabel> read_landmark_labels(const LabelSourceOptions& options, const Crs& crs, int& merged) {
  if (options.labels.empty()) throw UsageError("labels is missing; give --labels FILE");
  if (options.class_name.empty() && options.class_field.empty()) {
    throw UsageError("class_field is empty; give --class or --class-field");
  }
  std::vector<LandmarkLabel> labels;
  for (const std::string& file : options.labels) {
    if (is_annotation_file(file)) {
      add_annotations(file, options, crs, labels);
    } else {
      add_shapes(file, options, crs, labels);
    }
  }
  for (const LandmarkLabel& label : labels) {
    if (!(outline_area(label.outline_m) > 0)) throw DataError(label.name + ": is an outline without extent");
  }
  if (labels.empty()) {
    throw DataError(join(options.labels, ", ") + ": hold no label" +
                    (options.classes.empty() ? "" : " of the classes " + join(options.classes, ", ")));
  }
  return without_twins(std::move(labels), merged);
}

}  // namespace pilotage
