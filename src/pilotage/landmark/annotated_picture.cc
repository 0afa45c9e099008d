#include "pilotage/landmark/annotated_picture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/landmark/outline.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gdal_xml.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{256} << 20;

struct PixelBox {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;
};

/// The corners of a box turned clockwise (as the picture is seen) about its middle, from the upper left one.
std::vector<Vector2d> corners_of(const PixelBox& box, double angle_rad, const std::string& name) {
  if (!(box.width > 0 && box.height > 0)) {
    throw DataError(name + ": is a box without extent, " + format_number(box.width) + " x " +
                    format_number(box.height) + " pixels");
  }
  const Vector2d middle(box.left + box.width / 2, box.top + box.height / 2);
  const Vector2d across(std::cos(angle_rad), std::sin(angle_rad));
  const Vector2d down(-across.y(), across.x());
  const Vector2d w = across * (box.width / 2);
  const Vector2d h = down * (box.height / 2);
  return {middle - w - h, middle + w - h, middle + w + h, middle - w + h};
}

/// The first of these that is there.
std::optional<fs::path> existing(const std::vector<fs::path>& candidates) {
  std::error_code ignored;
  for (const fs::path& candidate : candidates) {
    if (fs::is_regular_file(candidate, ignored)) return candidate;
  }
  return std::nullopt;
}

fs::path picture_named(const std::string& file, const fs::path& annotations) {
  const fs::path folder = annotations.parent_path();
  std::vector<fs::path> candidates{folder / file};
  for (const fs::path& base : {folder, folder / ".."}) {
    for (const char* images : {"images", "JPEGImages"}) candidates.push_back(base / images / file);
  }
  if (const auto found = existing(candidates)) return *found;
  throw DataError(name_as_utf8(annotations.string()) + ": names the picture " + file +
                  ", which is neither beside it nor in a folder images");
}

double number_of(const std::string* text, const std::string& what) {
  const std::optional<double> number = text == nullptr ? std::nullopt : parse_number(*text);
  if (!number || !std::isfinite(*number)) {
    throw DataError(what + (text == nullptr ? ": is missing" : ": \"" + *text + "\" is no number"));
  }
  return *number;
}

bool is_set(const std::string* flag) {
  return flag != nullptr && *flag != "0" && *flag != "false";
}

PictureLabel imglab_label(const XmlElement& element, const std::string& name) {
  const auto number = [&](const char* key) {
    return number_of(element.attribute(key), name + ": its attribute " + key);
  };
  PictureLabel label;
  label.name = name;
  label.class_name = element.child_text("label");
  label.ignore = is_set(element.attribute("ignore"));
  const std::string* angle = element.attribute("angle");
  label.outline_px = corners_of({number("left"), number("top"), number("width"), number("height")},
                                angle == nullptr ? 0 : number("angle"), name);
  label.box_alone = angle == nullptr;
  std::map<std::int64_t, Vector2d> parts;
  for (const XmlElement& child : element.children) {
    if (child.name != "part") continue;
    const std::string* part = child.attribute("name");
    if (part == nullptr) throw DataError(name + ": has a part without a name");
    constexpr double kMostCorners = 100000;
    const std::optional<double> place = parse_number(*part);
    if (!place) continue;  // a point that somebody named, as "mast": no corner
    if (!(*place >= 0 && *place < kMostCorners && *place == std::floor(*place)) ||
        parts.contains(std::llround(*place))) {
      throw DataError(name + ": its part " + *part + " is no place of a corner, a whole number that no other part has");
    }
    parts[std::llround(*place)] = {number_of(child.attribute("x"), name + ": x of part " + *part),
                                   number_of(child.attribute("y"), name + ": y of part " + *part)};
  }
  if (parts.size() >= 3) {
    label.outline_px.clear();
    label.box_alone = false;
    for (const auto& [corner, point] : parts) label.outline_px.push_back(point);
  }
  return label;
}

std::vector<AnnotatedPicture> imglab_pictures(const fs::path& path, const std::string& file, const XmlElement& root) {
  std::vector<AnnotatedPicture> pictures;
  const XmlElement* images = root.child("images");
  if (images == nullptr) throw DataError(file + ": is an imglab dataset without images");
  for (const XmlElement& image : images->children) {
    if (image.name != "image") continue;
    const std::string* name = image.attribute("file");
    if (name == nullptr) throw DataError(file + ": has an image without the attribute file");
    AnnotatedPicture& picture = pictures.emplace_back();
    picture.picture = picture_named(*name, path);
    for (const XmlElement& box : image.children) {
      if (box.name != "box") continue;
      picture.labels.push_back(
          imglab_label(box, file + ": " + *name + ", box " + std::to_string(picture.labels.size() + 1)));
    }
  }
  return pictures;
}

AnnotatedPicture voc_picture(const fs::path& path, const std::string& file, const XmlElement& root) {
  AnnotatedPicture picture;
  picture.picture = picture_named(root.child_text("filename"), path);
  if (const XmlElement* size = root.child("size")) {
    const auto pixels = [&](const char* key) {
      const std::string text = size->child_text(key);
      return static_cast<int>(std::clamp(number_of(&text, file + ": its size's " + key), 0.0, 1e9));
    };
    picture.width_px = pixels("width");
    picture.height_px = pixels("height");
  }
  for (const XmlElement& object : root.children) {
    if (object.name != "object") continue;
    PictureLabel& label = picture.labels.emplace_back();
    label.name = file + ": object " + std::to_string(picture.labels.size());
    label.class_name = object.child_text("name");
    label.box_alone = true;
    const std::string difficult = object.child_text("difficult");
    label.ignore = is_set(&difficult) && !difficult.empty();
    const XmlElement* box = object.child("bndbox");
    if (box == nullptr) throw DataError(label.name + ": has no bndbox");
    const auto number = [&](const char* key) {
      const std::string text = box->child_text(key);
      return number_of(&text, label.name + ": its " + key);
    };
    const double left = number("xmin") - 1;  // counted from 1, and the last pixel is part of it
    const double top = number("ymin") - 1;
    label.outline_px = corners_of({left, top, number("xmax") - left, number("ymax") - top}, 0, label.name);
  }
  return picture;
}

std::vector<AnnotatedPicture> coco_pictures(const fs::path& path, const std::string& file,
                                            const nlohmann::ordered_json& json) {
  JsonObject root(json, file);
  std::map<std::int64_t, std::string> classes;
  for (JsonObject& category : root.objects("categories")) classes[category.integer("id")] = category.text("name");
  std::vector<AnnotatedPicture> pictures;
  std::map<std::int64_t, std::size_t> places;
  for (JsonObject& image : root.objects("images")) {
    places[image.integer("id")] = pictures.size();
    AnnotatedPicture& picture = pictures.emplace_back();
    picture.picture = picture_named(image.text("file_name"), path);
    if (image.has_value("width")) picture.width_px = image.small_integer("width", 0);
    if (image.has_value("height")) picture.height_px = image.small_integer("height", 0);
  }
  for (JsonObject& annotation : root.objects("annotations")) {
    PictureLabel label;
    label.name = annotation.where();
    const auto place = places.find(annotation.integer("image_id"));
    if (place == places.end()) annotation.fail("image_id", "the id of one of the images");
    const auto found = classes.find(annotation.integer("category_id"));
    if (found == classes.end()) annotation.fail("category_id", "the id of one of the categories");
    label.class_name = found->second;
    label.ignore = annotation.has_value("iscrowd") && annotation.integer("iscrowd") != 0;
    const bool polygons = annotation.has_value("segmentation") && annotation.value("segmentation").is_array() &&
                          !annotation.value("segmentation").empty();
    if (polygons) {
      for (const nlohmann::ordered_json& polygon : annotation.value("segmentation")) {
        if (!polygon.is_array() || polygon.size() < 6 || polygon.size() % 2 != 0) {
          annotation.fail("segmentation", "polygons x, y, x, y, … of three corners at least");
        }
        std::vector<Vector2d> outline;
        for (std::size_t i = 0; i < polygon.size(); i += 2) {
          if (!polygon[i].is_number() || !polygon[i + 1].is_number()) annotation.fail("segmentation", "numbers");
          outline.emplace_back(polygon[i].get<double>(), polygon[i + 1].get<double>());
        }
        // What something hides a part of has several; slivers beside it are no landmark.
        if (outline_area(outline) > outline_area(label.outline_px)) label.outline_px = std::move(outline);
      }
    } else {
      const std::vector<double> box = annotation.numbers("bbox", 4);
      label.outline_px = corners_of({box[0], box[1], box[2], box[3]}, 0, label.name);
      label.box_alone = true;
    }
    pictures[place->second].labels.push_back(std::move(label));
  }
  return pictures;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

std::vector<std::string> yolo_classes(const fs::path& path, const fs::path& class_names) {
  if (!class_names.empty()) return lines_of(read_file(class_names, kMostBytes));
  const fs::path folder = path.parent_path();
  std::vector<fs::path> candidates;
  for (const fs::path& base : {folder, folder / ".."}) {
    for (const char* file : {"classes.txt", "obj.names"}) candidates.push_back(base / file);
  }
  const auto found = existing(candidates);
  if (!found) {
    throw DataError(name_as_utf8(path.string()) +
                    ": its classes are numbers, and no classes.txt stands beside it; give --class-names");
  }
  return lines_of(read_file(*found, kMostBytes));
}

AnnotatedPicture yolo_picture(const fs::path& path, const std::string& file, const fs::path& class_names,
                              bool class_names_asked) {
  AnnotatedPicture picture;
  std::vector<fs::path> candidates;
  for (const char* extension : {".tif", ".png", ".jpg", ".jpeg", ".TIF", ".PNG", ".JPG"}) {
    const std::string name = path.stem().string() + extension;
    candidates.push_back(path.parent_path() / name);
    candidates.push_back(path.parent_path() / ".." / "images" / name);
  }
  const auto found = existing(candidates);
  if (!found) throw DataError(file + ": no picture of its name stands beside it or in ../images");
  picture.picture = *found;
  const ImageryInfo info = inspect_picture(found->string());
  const std::vector<std::string> classes =
      class_names_asked ? yolo_classes(path, class_names) : std::vector<std::string>{};
  const std::vector<std::string> lines = lines_of(read_file(path, kMostBytes));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::vector<std::string> words = words_of(lines[i]);
    if (words.empty()) continue;
    PictureLabel label;
    label.name = file + ": line " + std::to_string(i + 1);
    std::vector<double> numbers;
    for (const std::string& word : words) numbers.push_back(number_of(&word, label.name));
    const bool is_box = numbers.size() == 5 || numbers.size() == 6;  // the sixth is a detector's confidence
    if (!is_box && (numbers.size() < 7 || numbers.size() % 2 == 0)) {
      throw DataError(label.name + ": is neither \"class x y width height\" nor \"class x1 y1 x2 y2 x3 y3 …\"");
    }
    const double number = numbers.front();
    if (class_names_asked &&
        (!(number >= 0 && number < static_cast<double>(classes.size()) && number == std::floor(number)) ||
         classes[static_cast<std::size_t>(number)].empty())) {
      throw DataError(label.name + ": class " + format_number(number) + " has no name; " +
                      std::to_string(classes.size()) + " are known");
    }
    if (class_names_asked) label.class_name = classes[static_cast<std::size_t>(number)];
    const auto width = static_cast<double>(info.width_px);
    const auto height = static_cast<double>(info.height_px);
    if (is_box) {
      label.box_alone = true;
      label.outline_px = corners_of({(numbers[1] - numbers[3] / 2) * width, (numbers[2] - numbers[4] / 2) * height,
                                     numbers[3] * width, numbers[4] * height},
                                    0, label.name);
    } else {
      for (std::size_t k = 1; k + 1 < numbers.size(); k += 2) {
        label.outline_px.emplace_back(numbers[k] * width, numbers[k + 1] * height);
      }
    }
    picture.labels.push_back(std::move(label));
  }
  return picture;
}

void check_labels(const std::vector<AnnotatedPicture>& pictures) {
  for (const AnnotatedPicture& picture : pictures) {
    for (const PictureLabel& label : picture.labels) {
      if (!(outline_area(label.outline_px) > 0)) throw DataError(label.name + ": is an outline without extent");
    }
  }
}

bool is_yolo(const fs::path& path) {
  return path.extension() == ".txt" || path.extension() == ".TXT";
}

}  // namespace

bool is_annotation_file(const fs::path& path) {
  if (is_yolo(path)) return true;
  const std::string bytes = read_file(path, kMostBytes);
  const std::string_view text = without_byte_order_mark(bytes);
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return false;
  if (text[first] == '<') {
    const std::string_view head = text.substr(0, 4096);
    return head.find("<dataset") != std::string_view::npos || head.find("<annotation") != std::string_view::npos;
  }
  if (text[first] != '{') return false;
  const nlohmann::ordered_json json = parse_json(name_as_utf8(path.string()), text);
  return json.is_object() && json.contains("annotations") && json.contains("images") && !json.contains("type");
}

std::vector<AnnotatedPicture> read_annotations(const fs::path& path, const fs::path& class_names,
                                               bool class_names_asked) {
  const std::string file = name_as_utf8(path.string());
  std::vector<AnnotatedPicture> pictures;
  if (is_yolo(path)) {
    pictures.push_back(yolo_picture(path, file, class_names, class_names_asked));
  } else {
    const std::string bytes = read_file(path, kMostBytes);
    const std::string_view text = without_byte_order_mark(bytes);
    const auto first = text.find_first_not_of(" \t\r\n");
    if (first != std::string_view::npos && text[first] == '{') {
      pictures = coco_pictures(path, file, parse_json(file, text));
    } else {
      const XmlElement root = parse_xml(file, text);
      if (root.name == "dataset") {
        pictures = imglab_pictures(path, file, root);
      } else if (root.name == "annotation") {
        pictures.push_back(voc_picture(path, file, root));
      } else {
        throw DataError(file + ": is XML with <" + root.name + ">, neither imglab's <dataset> nor VOC's <annotation>");
      }
    }
  }
  check_labels(pictures);
  return pictures;
}

std::string imglab_xml(const std::vector<AnnotatedPicture>& pictures, std::string_view name) {
  std::string text =
      "<?xml version='1.0' encoding='UTF-8'?>\n<dataset>\n<name>" + html_escape(name) + "</name>\n<images>\n";
  for (const AnnotatedPicture& picture : pictures) {
    text += "  <image file='" + html_escape(name_as_utf8(picture.picture.string())) + "'>\n";
    for (const PictureLabel& label : picture.labels) {
      Vector2d low = label.outline_px.front();
      Vector2d high = low;
      for (const Vector2d& point : label.outline_px) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
      }
      const std::int64_t left = std::llround(low.x());
      const std::int64_t top = std::llround(low.y());
      text += "    <box top='" + std::to_string(top) + "' left='" + std::to_string(left) + "' width='" +
              std::to_string(std::max<std::int64_t>(std::llround(high.x()) - left, 1)) + "' height='" +
              std::to_string(std::max<std::int64_t>(std::llround(high.y()) - top, 1)) + "'" +
              (label.ignore ? " ignore='1'" : "") + ">\n      <label>" + html_escape(label.class_name) + "</label>\n";
      for (std::size_t i = 0; i < label.outline_px.size() && !label.box_alone; ++i) {
        const std::string number = std::to_string(i);
        text += "      <part name='" + std::string(number.size() < 3 ? 3 - number.size() : 0, '0') + number + "' x='" +
                std::to_string(std::lround(label.outline_px[i].x())) + "' y='" +
                std::to_string(std::lround(label.outline_px[i].y())) + "'/>\n";  // imglab reads whole numbers
      }
      text += "    </box>\n";
    }
    text += "  </image>\n";
  }
  return text + "</images>\n</dataset>\n";
}

}  // namespace pilotage
