#include <map>
#include <string>

#include <ogr_geometry.h>

#include "pilotage/base/error.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_shapes.h"
#include "pilotage/raster/gdal_vector.h"

namespace pilotage {
namespace {

/// "#rrggbbaa" as KML writes it: opacity, blue, green, red.
std::string kml_color(const std::string& color) {
  if (color.size() != 9) throw UsageError("\"" + color + "\" is not a colour of the form #rrggbbaa");
  return color.substr(7, 2) + color.substr(5, 2) + color.substr(3, 2) + color.substr(1, 2);
}

std::string element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + html_escape(text) + "</" + name + ">";
}

std::string style_text(const VectorStyle& style) {
  return "<LineStyle>" + element("color", kml_color(style.line_color)) +
         element("width", format_number(style.line_width_px)) + "</LineStyle><PolyStyle>" +
         (style.fill_color.empty() ? element("fill", "0") : element("color", kml_color(style.fill_color))) +
         "</PolyStyle>";
}

/// Each style of the document once, numbered in the order in which they come.
class StyleList {
 public:
  std::string url_of(const VectorStyle& style) {
    const std::string text = style_text(style);
    const auto [found, added] = ids_.try_emplace(text, "s" + std::to_string(ids_.size()));
    if (added) elements_ += "<Style id=\"" + found->second + "\">" + text + "</Style>\n";
    return "#" + found->second;
  }
  const std::string& elements() const { return elements_; }

 private:
  std::map<std::string, std::string> ids_;
  std::string elements_;
};

constexpr int kDecimals = 7;  // about a centimetre

std::string coordinates(const OGRSimpleCurve& curve) {
  std::string text = "<coordinates>";
  for (int i = 0; i < curve.getNumPoints(); ++i) {
    if (i > 0) text += " ";
    text += format_fixed(curve.getX(i), kDecimals) + "," + format_fixed(curve.getY(i), kDecimals) + ",0";
  }
  return text + "</coordinates>";
}

std::string shape_text(const OGRGeometry& shape) {
  switch (wkbFlatten(shape.getGeometryType())) {
    case wkbPoint:
      return "<Point><coordinates>" + format_fixed(shape.toPoint()->getX(), kDecimals) + "," +
             format_fixed(shape.toPoint()->getY(), kDecimals) + ",0</coordinates></Point>";
    case wkbLineString:
      return "<LineString><tessellate>1</tessellate>" + coordinates(*shape.toLineString()) + "</LineString>";
    case wkbPolygon: {
      const OGRPolygon& polygon = *shape.toPolygon();
      std::string text = "<Polygon><tessellate>1</tessellate><outerBoundaryIs><LinearRing>" +
                         coordinates(*polygon.getExteriorRing()) + "</LinearRing></outerBoundaryIs>";
      for (int i = 0; i < polygon.getNumInteriorRings(); ++i) {
        text += "<innerBoundaryIs><LinearRing>" + coordinates(*polygon.getInteriorRing(i)) +
                "</LinearRing></innerBoundaryIs>";
      }
      return text + "</Polygon>";
    }
    default: {
      std::string text = "<MultiGeometry>";
      for (const OGRGeometry* part : *shape.toGeometryCollection()) text += shape_text(*part);
      return text + "</MultiGeometry>";
    }
  }
}

std::string value_text(const VectorValue& value) {
  struct Visitor {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t number) const { return std::to_string(number); }
    std::string operator()(double number) const { return format_number(number); }
    std::string operator()(const std::string& text) const { return text; }
  };
  return std::visit(Visitor{}, value);
}

std::string placemark(const VectorLayer& layer, const VectorFeature& feature, const OGRGeometry& shape,
                      StyleList& styles) {
  check_values(layer, feature);
  std::string text = "<Placemark>" + element("name", feature.title);
  if (!feature.note.empty()) text += element("description", feature.note);
  text += element("styleUrl", styles.url_of(feature.style)) + "\n<ExtendedData>";
  for (std::size_t i = 0; i < layer.columns.size(); ++i) {
    if (std::holds_alternative<std::monostate>(feature.values[i])) continue;
    const VectorColumn& column = layer.columns[i];
    text += "<Data name=\"" + html_escape(column.name) + "\">" +
            element("displayName", column.title.empty() ? column.name : column.title) +
            element("value", value_text(feature.values[i])) + "</Data>";
  }
  return text + "</ExtendedData>\n" + shape_text(shape) + "</Placemark>\n";
}

}  // namespace

std::string kml_document(const std::string& title, const std::vector<VectorLayer>& layers) {
  StyleList styles;
  std::string folders;
  for (const VectorLayer& layer : layers) {
    if (layer.shape == VectorShape::kNone) continue;
    const std::vector<GeometryPtr> shapes = shapes_of(layer, true);
    folders += "<Folder id=\"" + html_escape(layer.name) + "\">" + element("name", layer.title) +
               element("visibility", layer.visible ? "1" : "0") + element("description", layer.description) + "\n";
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      folders += placemark(layer, layer.features[i], *shapes[i], styles);
    }
    folders += "</Folder>\n";
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>" +
         element("name", title) + "\n" + styles.elements() + folders + "</Document>\n</kml>\n";
}

}  // namespace pilotage
