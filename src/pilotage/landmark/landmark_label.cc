#include "pilotage/landmark/landmark_label.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/annotated_picture.h"
#include "pilotage/landmark/outline.h"
#include "pilotage/route/ogr_shapes.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

/// Two labels that cover so much of the same ground are of one thing.
constexpr double kSameThing = 0.7;

std::string property(const GeodeticShape& shape, const std::string& key) {
  const auto found = shape.properties->find(key);
  return found == shape.properties->end() ? "" : found->second;
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

/// Nothing when a corner has no image in the CRS.
std::optional<std::vector<Vector2d>> placed(const std::vector<GeodeticPoint>& points, const CrsTransform& transform) {
  std::vector<Vector2d> placed;
  for (const GeodeticPoint& point : points) {
    const auto on_map = transform.map_from_geodetic(point);
    if (!on_map || !on_map->allFinite()) return std::nullopt;
    placed.push_back(*on_map);
  }
  return placed;
}

/// "12" or "12 m", as OpenStreetMap writes lengths.
std::optional<double> metres_of(std::string text) {
  for (const char* unit : {" m", "m"}) {
    if (text.ends_with(unit)) text.resize(text.size() - std::string_view(unit).size());
  }
  return parse_number(text);
}

/// Nothing when it is nowhere on the map.
std::optional<std::vector<Vector2d>> outline_of(const GeodeticShape& shape, const LabelSourceOptions& options,
                                                const CrsTransform& transform) {
  std::optional<std::vector<Vector2d>> outline = placed(shape.rings.front(), transform);
  if (!outline) return outline;
  if (shape.kind == ShapeKind::kPoint) {
    const std::string text = property(shape, "diameter");
    const std::optional<double> diameter_m = text.empty() ? options.diameter_m : metres_of(text);
    if (!text.empty() && !(diameter_m && *diameter_m > 0 && *diameter_m < 1e5)) {
      throw DataError(shape.name + ": its diameter \"" + text + "\" is no number of metres from 0 to 100000");
    }
    if (!diameter_m) throw DataError(shape.name + ": is a point, and nobody says its size; give --diameter-m");
    return circle_outline(outline->front(), *diameter_m);
  }
  if (shape.kind == ShapeKind::kLine) {
    const bool closed = outline->size() > 3 && (outline->front() - outline->back()).norm() < 1e-6;
    if (!closed) throw DataError(shape.name + ": is an open line; a landmark is a polygon, a closed line or a point");
    outline->pop_back();
  }
  return outline;
}

void add_shapes(const std::string& file, const LabelSourceOptions& options, const Crs& crs, LandmarkLabels& found) {
  const CrsTransform transform(crs);
  std::set<std::string> fields;
  bool any = false;
  const std::vector<GeodeticShape> shapes = read_shapes(file);
  if (shapes.empty()) throw DataError(file + ": holds no shape");
  for (const GeodeticShape& shape : shapes) {
    for (const auto& [key, value] : *shape.properties) fields.insert(key);
    const std::string class_name = class_of(shape, options);
    any = any || !class_name.empty();
    if (!is_wanted(class_name, options)) continue;
    if (!shape.problem.empty()) {
      found.nowhere.push_back(shape.name + ": " + shape.problem);
      continue;
    }
    std::optional<std::vector<Vector2d>> outline = outline_of(shape, options, transform);
    if (!outline) {
      found.nowhere.push_back(shape.name + ": has no image in " + crs.name());
      continue;
    }
    // The two flags are those of labels.geojson of an earlier run.
    found.labels.push_back({class_name, std::move(*outline), property(shape, "box_alone") == "1",
                            property(shape, "ignore") == "1", property(shape, "start_date"),
                            property(shape, "end_date"), shape.name});
  }
  if (any) return;
  const std::vector<std::string> known(fields.begin(), fields.end());
  throw DataError(file + ": no shape has a property " + options.class_field +
                  "; give --class, or --class-field with one of: " + (known.empty() ? "(none)" : join(known, ", ")));
}

ImageryInfo place_of_picture(const AnnotatedPicture& picture, const std::string& imagery_crs) {
  const std::string& first = picture.labels.front().name;
  ImageryOptions options;
  options.imagery_crs = imagery_crs;
  options.collar = CollarRule::kKeep;
  const ImageryInfo info = [&] {
    try {
      return inspect_imagery(picture.picture.string(), options);
    } catch (const DataError& error) {
      throw DataError(first + ": its picture has no place on the ground: " + error.what());
    }
  }();
  if (info.control_points) {
    throw DataError(first +
                    ": its picture is placed by control points, which bend its pixels; warp it first (gdalwarp) "
                    "and label that");
  }
  const auto size_text = [](int width, int height) { return std::to_string(width) + " x " + std::to_string(height); };
  const bool differs = (picture.width_px > 0 && picture.width_px != info.width_px) ||
                       (picture.height_px > 0 && picture.height_px != info.height_px);
  if (differs) {
    throw DataError(first + ": was drawn on a picture of " + size_text(picture.width_px, picture.height_px) +
                    " px, and the picture has " + size_text(info.width_px, info.height_px));
  }
  return info;
}

void add_annotations(const std::string& file, const LabelSourceOptions& options, const std::string& imagery_crs,
                     const Crs& crs, LandmarkLabels& found) {
  constexpr double kBeyond_px = 1;  // by how much annotators reach over the edge
  const CrsTransform transform(crs);
  for (const AnnotatedPicture& picture : read_annotations(file, options.class_names, options.class_name.empty())) {
    if (picture.labels.empty()) continue;
    const ImageryInfo info = place_of_picture(picture, imagery_crs);
    const CrsTransform of_picture(info.crs);
    for (const PictureLabel& label : picture.labels) {
      const std::string class_name = options.class_name.empty() ? label.class_name : options.class_name;
      if (class_name.empty()) throw DataError(label.name + ": has no class; give --class");
      if (!is_wanted(class_name, options)) continue;
      std::vector<GeodeticPoint> corners;
      for (const Vector2d& corner_px : label.outline_px) {
        const bool inside = corner_px.x() >= -kBeyond_px && corner_px.x() <= info.width_px + kBeyond_px &&
                            corner_px.y() >= -kBeyond_px && corner_px.y() <= info.height_px + kBeyond_px;
        // On a chip of an earlier run its neighbours are there with those parts that reach out of it.
        if (!inside && !label.ignore) {
          throw DataError(label.name + ": reaches out of its picture of " + std::to_string(info.width_px) + " x " +
                          std::to_string(info.height_px) + " px");
        }
        const auto corner = of_picture.geodetic_from_map(info.map_from_pixel.map_from_pixel(corner_px));
        if (corner) corners.push_back(*corner);
      }
      std::optional<std::vector<Vector2d>> outline =
          corners.size() == label.outline_px.size() ? placed(corners, transform) : std::nullopt;
      if (!outline) {
        found.nowhere.push_back(label.name + ": has no image in " + crs.name());
        continue;
      }
      found.labels.push_back({class_name, std::move(*outline), label.box_alone, label.ignore, "", "", label.name});
    }
  }
}

/// Two labels of one thing have about the same size and place: each is compared with those of its size, to a factor of
/// two, in the cells around it.
using SizeCell = std::array<std::int64_t, 3>;

SizeCell cell_of_box(const OrientedBox& box, std::int64_t octave) {
  const double side_m = std::ldexp(1.0, static_cast<int>(octave));
  return {octave, std::llround(box.center.x() / side_m), std::llround(box.center.y() / side_m)};
}

std::int64_t octave_of(const OrientedBox& box) {
  return static_cast<std::int64_t>(std::floor(std::log2(std::max(box.length, 1e-3))));
}

void merge_twins(LandmarkLabels& found) {
  std::map<SizeCell, std::vector<std::size_t>> cells;
  std::vector<LandmarkLabel> kept;
  std::vector<OrientedBox> boxes;
  for (LandmarkLabel& label : found.labels) {
    const OrientedBox box = oriented_box(label.outline_m);
    std::optional<std::size_t> twin;
    for (std::int64_t octave = octave_of(box) - 1; octave <= octave_of(box) + 1 && !twin; ++octave) {
      const SizeCell here = cell_of_box(box, octave);
      for (std::int64_t step = 0; step < 9 && !twin; ++step) {
        const auto near = cells.find({octave, here[1] + step % 3 - 1, here[2] + step / 3 - 1});
        if (near == cells.end()) continue;
        for (const std::size_t other : near->second) {
          if (overlap(boxes[other], box) <= kSameThing) continue;
          if (kept[other].class_name == label.class_name) {
            twin = other;
            break;
          }
          if (!kept[other].ignore && !label.ignore) {
            throw DataError(label.name + ": is a " + label.class_name + " where " + kept[other].name +
                            " has labelled a " + kept[other].class_name);
          }
        }
      }
    }
    if (twin) {
      // On chips of an earlier run a landmark is ignored beside another one, and counts on its own.
      const bool counts = kept[*twin].ignore && !label.ignore;
      if (!kept[*twin].ignore && !label.ignore) ++found.merged;
      if (counts) kept[*twin] = std::move(label);
      continue;
    }
    cells[cell_of_box(box, octave_of(box))].push_back(kept.size());
    boxes.push_back(box);
    kept.push_back(std::move(label));
  }
  found.labels = std::move(kept);
}

/// Of dates as OpenStreetMap writes them: "1998", "1998-05", "1998-05-31". What is a moment is cut to its day, what is
/// anything else ("~1990", "C19") is left out, and told.
bool cut_to_date(std::string& date) {
  static const std::regex kDate("[0-9]{4}(-[0-9]{2}(-[0-9]{2}(T.*)?)?)?");
  if (date.empty()) return true;
  const bool known = std::regex_match(date, kDate);
  date = known ? date.substr(0, 10) : "";
  return known;
}

void check_dates(LandmarkLabels& found) {
  std::int64_t odd = 0;
  std::string first;
  for (LandmarkLabel& label : found.labels) {
    const std::string start = label.start_date;
    const std::string end = label.end_date;
    const bool known_start = cut_to_date(label.start_date);
    const bool known_end = cut_to_date(label.end_date);
    if (known_start && known_end) continue;
    if (odd++ == 0) first = label.name + ": \"" + (known_start ? end : start) + "\"";
  }
  if (odd == 0) return;
  found.warnings.push_back(std::to_string(odd) +
                           " labels have dates that are none (YYYY, YYYY-MM, YYYY-MM-DD) and were "
                           "not compared with the imagery's; the first is " +
                           first);
}

}  // namespace

void ImageryDates::add(const std::string& acquired) {
  const std::string day = acquired.substr(0, 10);
  if (day.empty()) return;
  if (first.empty() || day < first) first = day;
  if (day > last) last = day;
}

std::string date_misfit(const LandmarkLabel& label, const ImageryDates& dates) {
  if (dates.first.empty()) return "";
  if (!label.start_date.empty() && label.start_date > dates.last.substr(0, label.start_date.size())) {
    return "begins " + label.start_date + ", after the imagery of " + dates.last;
  }
  if (!label.end_date.empty() && label.end_date < dates.first.substr(0, label.end_date.size())) {
    return "ended " + label.end_date + ", before the imagery of " + dates.first;
  }
  return "";
}

LandmarkLabels read_landmark_labels(const LabelSourceOptions& options, const std::string& imagery_crs, const Crs& crs) {
  if (options.labels.empty()) throw UsageError("labels is missing; give --labels FILE");
  if (options.class_name.empty() && options.class_field.empty()) {
    throw UsageError("class_field is empty; give --class or --class-field");
  }
  LandmarkLabels found;
  for (const std::string& file : options.labels) {
    if (is_annotation_file(file)) {
      add_annotations(file, options, imagery_crs, crs, found);
    } else {
      add_shapes(file, options, crs, found);
    }
  }
  if (found.labels.empty() && found.nowhere.empty()) {
    throw DataError(join(options.labels, ", ") + ": hold no label" +
                    (options.classes.empty() ? "" : " of the classes " + join(options.classes, ", ")));
  }
  check_dates(found);
  merge_twins(found);
  return found;
}

}  // namespace pilotage
