#include "pilotage/gis/qgis_style.h"

#include <utility>

#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"

namespace pilotage {
namespace {

using Properties = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kHead =
    "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
    "<qgis version=\"3.22.0\" styleCategories=\"Symbology|Fields\">\n";
constexpr int kColorStops = 33;  // of the 256 colours of a map; QGIS interpolates between them
constexpr int kScaleClasses = 5;

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + html_escape(value) + "\"";
}

std::string channels(Rgb color, int alpha = 255) {
  return std::to_string(color.red) + "," + std::to_string(color.green) + "," + std::to_string(color.blue) + "," +
         std::to_string(alpha);
}

/// "1" is the unit of plain numbers, which need none.
std::string unit_suffix(const Measure& measure) {
  return measure.heat.unit == "1" ? "" : " " + measure.heat.unit;
}

std::string symbol_layer(const std::string& kind, const Properties& properties) {
  std::string text = "      <layer" + attribute("class", kind) + " enabled=\"1\" locked=\"0\" pass=\"0\">\n";
  for (const auto& [key, value] : properties) {
    text += "        <prop" + attribute("k", key) + attribute("v", value) + "/>\n";
  }
  return text + "      </layer>\n";
}

std::string symbol(std::size_t index, const std::string& type, const std::string& opacity, const std::string& layers) {
  return "    <symbol" + attribute("name", std::to_string(index)) + attribute("type", type) +
         attribute("alpha", opacity) + " clip_to_extent=\"1\" force_rhr=\"0\">\n" + layers + "    </symbol>\n";
}

std::string line_layer(Rgb color, double width_mm, bool dashed) {
  return symbol_layer("SimpleLine", {{"line_color", channels(color)},
                                     {"line_style", dashed ? "dash" : "solid"},
                                     {"line_width", format_number(width_mm)},
                                     {"line_width_unit", "MM"},
                                     {"capstyle", "flat"},
                                     {"joinstyle", "round"}});
}

std::string fill_layer(const std::string& style, Rgb fill, Rgb line, const std::string& line_style, double width_mm) {
  return symbol_layer("SimpleFill", {{"color", channels(fill)},
                                     {"style", style},
                                     {"outline_color", channels(line)},
                                     {"outline_style", line_style},
                                     {"outline_width", format_number(width_mm)},
                                     {"outline_width_unit", "MM"}});
}

struct StyleRule {
  std::string filter;  ///< "" for all features.
  std::string label;
  std::string symbol_type;  ///< "fill", "line" or "marker".
  std::string opacity;
  std::string layers;
};

/// A rule-based renderer: every rule whose filter holds draws the feature, in this order.
std::string rules_style(const std::vector<StyleRule>& rules) {
  std::string list;
  std::string symbols;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const StyleRule& rule = rules[i];
    list += "      <rule" + attribute("key", "rule" + std::to_string(i)) + attribute("symbol", std::to_string(i)) +
            attribute("label", rule.label) + (rule.filter.empty() ? "" : attribute("filter", rule.filter)) + "/>\n";
    symbols += symbol(i, rule.symbol_type, rule.opacity, rule.layers);
  }
  return std::string(kHead) +
         "  <renderer-v2 type=\"RuleRenderer\" forceraster=\"0\" symbollevels=\"0\" enableorderby=\"0\">\n"
         "    <rules key=\"all\">\n" +
         list + "    </rules>\n    <symbols>\n" + symbols +
         "    </symbols>\n  </renderer-v2>\n  <blendMode>0</blendMode>\n  <layerOpacity>1</layerOpacity>\n</qgis>\n";
}

}  // namespace

std::string qgis_heat_style(const MeasureScale& scale, int band) {
  const auto colors = color_table(scale.measure.heat.colors);
  const auto stop_color = [&](int stop) { return colors[static_cast<std::size_t>(stop * 255 / (kColorStops - 1))]; };
  const std::string low = format_number(scale.low);
  const std::string high = format_number(scale.high);
  const std::string suffix = unit_suffix(scale.measure);
  std::string items;
  std::string stops;
  for (int stop = 0; stop < kColorStops; ++stop) {
    const double share = static_cast<double>(stop) / (kColorStops - 1);
    const double value = scale.low + share * (scale.high - scale.low);
    items += "          <item" + attribute("value", format_number(value)) + " alpha=\"255\"" +
             attribute("color", hex_color(stop_color(stop))) +
             attribute("label", number_text(value, scale.measure.heat.decimals) + suffix) + "/>\n";
    if (stop == 0 || stop == kColorStops - 1) continue;
    stops += (stops.empty() ? "" : ":") + format_number(share) + ";" + channels(stop_color(stop));
  }
  return std::string(kHead) + "  <pipe>\n    <rasterrenderer type=\"singlebandpseudocolor\"" +
         attribute("band", std::to_string(band)) + attribute("classificationMin", low) +
         attribute("classificationMax", high) +
         " opacity=\"1\" alphaBand=\"-1\" nodataColor=\"\">\n      <rasterTransparency/>\n"
         "      <minMaxOrigin><limits>None</limits><extent>WholeRaster</extent>"
         "<statAccuracy>Exact</statAccuracy></minMaxOrigin>\n      <rastershader>\n"
         "        <colorrampshader colorRampType=\"INTERPOLATED\" classificationMode=\"1\" clip=\"0\"" +
         attribute("minimumValue", low) + attribute("maximumValue", high) +
         attribute("labelPrecision", std::to_string(scale.measure.heat.decimals)) +
         ">\n          <colorramp name=\"[source]\" type=\"gradient\">\n" + "            <prop" +
         attribute("k", "color1") + attribute("v", channels(stop_color(0))) + "/>\n            <prop" +
         attribute("k", "color2") + attribute("v", channels(stop_color(kColorStops - 1))) +
         "/>\n            <prop k=\"discrete\" v=\"0\"/>\n            <prop k=\"rampType\" v=\"gradient\"/>\n"
         "            <prop k=\"stops\"" +
         attribute("v", stops) + "/>\n          </colorramp>\n" + items +
         "          <rampLegendSettings useContinuousLegend=\"1\" orientation=\"2\" direction=\"0\" prefix=\"\"" +
         attribute("suffix", suffix) +
         attribute("minimumLabel", number_text(scale.low, scale.measure.heat.decimals) + suffix) +
         attribute("maximumLabel",
                   number_text(scale.high, scale.measure.heat.decimals) + suffix + " " + scale.measure.heat.title) +
         "/>\n        </colorrampshader>\n      </rastershader>\n    </rasterrenderer>\n  </pipe>\n"
         "  <blendMode>0</blendMode>\n</qgis>\n";
}

std::string qgis_class_style(const std::vector<RasterClass>& classes) {
  std::string entries;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const auto& [red, green, blue] = classes[i].rgb;
    entries += "        <paletteEntry" + attribute("value", std::to_string(i)) +
               attribute("color", hex_color({red, green, blue})) + attribute("label", classes[i].name) +
               " alpha=\"255\"/>\n";
  }
  return std::string(kHead) +
         "  <pipe>\n    <rasterrenderer type=\"paletted\" band=\"1\" opacity=\"1\" alphaBand=\"-1\" "
         "nodataColor=\"\">\n      <rasterTransparency/>\n      <colorPalette>\n" +
         entries + "      </colorPalette>\n    </rasterrenderer>\n  </pipe>\n  <blendMode>0</blendMode>\n</qgis>\n";
}

std::string with_aliases(const std::string& style, const std::vector<std::pair<std::string, std::string>>& titles) {
  std::string aliases = "  <aliases>\n";
  int index = 1;  // column 0 is the feature's number
  for (const auto& [name, title] : titles) {
    aliases += "    <alias" + attribute("field", name) + attribute("index", std::to_string(index++)) +
               attribute("name", title) + "/>\n";
  }
  std::string result = style;
  return result.insert(result.rfind("</qgis>"), aliases + "  </aliases>\n");
}

std::vector<ScaleClass> scale_classes(const MeasureScale& scale) {
  const auto colors = color_table(scale.measure.heat.colors);
  std::vector<ScaleClass> classes;
  for (int i = 0; i < kScaleClasses; ++i) {
    ScaleClass next;
    next.low = scale.low + (scale.high - scale.low) * i / kScaleClasses;
    next.high = scale.low + (scale.high - scale.low) * (i + 1) / kScaleClasses;
    next.color = colors[static_cast<std::size_t>((2 * i + 1) * 255 / (2 * kScaleClasses))];
    const std::string low = number_text(next.low, scale.measure.heat.decimals);
    const std::string high = number_text(next.high, scale.measure.heat.decimals);
    next.label = low + " – " + high;  // values beyond the scale take the end colours
    if (i == 0 && scale.least < scale.low) next.label = "below " + high;
    if (i + 1 == kScaleClasses && scale.most > scale.high) next.label = "from " + low;
    next.label += unit_suffix(scale.measure);
    classes.push_back(next);
  }
  return classes;
}

std::string qgis_tile_style(const MeasureScale& scale, bool selection) {
  constexpr Rgb kThin{0x80, 0x80, 0x80};
  constexpr Rgb kStrong{0x20, 0x20, 0x20};
  const std::string column = "\"" + scale.measure.name + "\"";
  const std::vector<ScaleClass> classes = scale_classes(scale);
  std::vector<StyleRule> rules;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    std::string filter;  // values beyond the scale take the end colours
    if (i > 0) filter = column + " >= " + format_number(classes[i].low);
    if (i + 1 < classes.size()) {
      filter += (filter.empty() ? "" : " AND ") + column + " < " + format_number(classes[i].high);
    }
    rules.push_back({filter, scale.measure.heat.title + " " + classes[i].label, "fill", "0.7",
                     fill_layer("solid", classes[i].color, kThin, "solid", 0.1)});
  }
  rules.push_back({column + " IS NULL", scale.measure.heat.title + ": not known", "fill", "1",
                   fill_layer("b_diagonal", kThin, kThin, "solid", 0.1)});
  if (selection) {
    rules.push_back({"\"selected\"", "matching area", "fill", "1", fill_layer("no", kStrong, kStrong, "solid", 0.4)});
  }
  return rules_style(rules);
}

std::string qgis_point_style(Rgb color, double size_mm) {
  const auto marker = [&](Rgb rim, double rim_mm) {
    return symbol_layer("SimpleMarker", {{"name", "circle"},
                                         {"color", "0,0,0,0"},
                                         {"size", format_number(size_mm)},
                                         {"size_unit", "MM"},
                                         {"outline_color", channels(rim)},
                                         {"outline_style", "solid"},
                                         {"outline_width", format_number(rim_mm)},
                                         {"outline_width_unit", "MM"}});
  };
  constexpr Rgb kWhite{0xff, 0xff, 0xff};
  return rules_style({{"", "", "marker", "1", marker(kWhite, 0.9) + marker(color, 0.4)}});
}

std::string qgis_outline_style(Rgb color, double width_mm) {
  return rules_style({{"", "", "fill", "1", fill_layer("no", color, color, "solid", width_mm)}});
}

std::string qgis_fill_style(const std::string& column, const std::vector<FillClass>& classes) {
  std::vector<StyleRule> rules;
  for (const FillClass& fill : classes) {
    rules.push_back({"\"" + column + "\" = '" + fill.value + "'", fill.label, "fill", "0.6",
                     fill_layer("solid", fill.color, fill.color, "solid", 0.2)});
  }
  return rules_style(rules);
}

std::string qgis_line_style(const std::string& column, const std::vector<LineClass>& classes) {
  std::vector<StyleRule> rules;
  for (const LineClass& line : classes) {
    const std::string filter = column.empty() ? "" : "\"" + column + "\" = '" + line.value + "'";
    rules.push_back({filter, line.label, "line", "1", line_layer(line.color, line.width_mm, line.dashed)});
  }
  return rules_style(rules);
}

}  // namespace pilotage
