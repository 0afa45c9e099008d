#include "pilotage/report/page_parts.h"

#include <cmath>
#include <cstdint>
#include <regex>

#include <nlohmann/json.hpp>

#include "pilotage/base/markup.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/page_assets.h"
#include "pilotage/report/page_text.h"

namespace pilotage {
namespace {

// "55°29'42.7\" N"
std::string dms(double degrees, char positive, char negative) {
  if (!std::isfinite(degrees)) return "–";
  const auto tenths = static_cast<std::int64_t>(std::llround(std::abs(degrees) * 36000));  // of a second
  const auto two = [](std::int64_t number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  return std::to_string(tenths / 36000) + "°" + two(tenths / 600 % 60) + "'" + two(tenths / 10 % 60) + "." +
         std::to_string(tenths % 10) + "\" " + (degrees < 0 ? negative : positive);
}

void append_parameters(const std::string& prefix, const nlohmann::ordered_json& json, std::string& html) {
  if (json.is_object()) {
    for (const auto& item : json.items()) {
      append_parameters(prefix.empty() ? item.key() : prefix + "." + item.key(), item.value(), html);
    }
    return;
  }
  html +=
      "<tr>" + heading_html(prefix) + cell_html(json.is_string() ? json.get<std::string>() : json.dump()) + "</tr>\n";
}

// The last line of Leaflet's files points debuggers to a map file that the page does not have.
std::string without_source_map(const std::string& text) {
  return std::regex_replace(text, std::regex(R"((//|/\*)# sourceMappingURL=[^\n]*)"), "");
}

// Leaflet's own pictures (layer button, default marker) are not used; a reference to a file that is not there must not
// stay.
std::string without_files(const std::string& css) {
  return std::regex_replace(css, std::regex(R"(url\([^)]*\))"), "none");
}

}  // namespace

std::string cell_html(const std::string& text) {
  return "<td>" + html_escape(text) + "</td>";
}

std::string cell_html(const std::string& label, const std::string& text) {
  return "<td data-label=\"" + label + "\">" + html_escape(text) + "</td>";
}

std::string heading_html(const std::string& text) {
  return "<th scope=\"row\">" + html_escape(text) + "</th>";
}

std::string table_html(const std::string& label, const std::vector<std::string>& heads, const std::string& rows) {
  std::string html = "  <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + html_escape(label) +
                     "\"><table class=\"wide cards\"><thead><tr>";
  for (const std::string& head : heads) html += "<th scope=\"col\">" + head + "</th>";
  return html + "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n";
}

std::string badge_html(std::string_view status) {
  return "<span class=\"badge " + std::string(status) + "\">" + std::string(status) + "</span>";
}

std::string badge_cell_html(std::string_view status) {
  return "<td data-label=\"Status\">" + badge_html(status) + "</td>";
}

std::string quality_rows_html(const std::vector<QualityRow>& rows) {
  std::string html;
  for (const QualityRow& row : rows) {
    html += "<tr>" + heading_html(row.label + (row.decides ? " *" : "")) + "<td data-label=\"Value\">" +
            html_escape(row.value) + " " + kind_mark(row.kind) + "</td>" + badge_cell_html(status_name(row.status)) +
            cell_html("Threshold", row.threshold) + cell_html("Advice", row.advice) + "</tr>\n";
  }
  return html;
}

std::string list_html(const std::vector<std::string>& texts) {
  std::string html;
  for (const std::string& text : texts) html += "<li>" + html_escape(text) + "</li>\n";
  return html.empty() ? "<li>None.</li>" : html;
}

std::string title_block_html(const std::vector<std::pair<std::string, std::string>>& block) {
  std::string html;
  for (const auto& [label, value] : block) {
    html += "<div><dt>" + html_escape(label) + "</dt><dd>" + html_escape(value) + "</dd></div>";
  }
  return html;
}

std::string imagery_html(const std::vector<ImageryDataset>& imagery) {
  std::string html;
  for (const ImageryDataset& raster : imagery) {
    html += "<tr>" + heading_html(raster.dataset) + cell_html(raster.acquired.empty() ? "unknown" : raster.acquired) +
            cell_html(number_text(raster.gsd_m, 3) + " m/px") + cell_html(raster.crs) +
            cell_html(std::to_string(raster.width_px) + " × " + std::to_string(raster.height_px) + " px") + "</tr>\n";
  }
  return html;
}

std::string inputs_html(const std::vector<InputFile>& inputs) {
  std::string html;
  for (const InputFile& file : inputs) {
    html += "<tr>" + heading_html(file.role) + cell_html(file.name) + cell_html(file.date) +
            cell_html(licence_text(file.licence)) + "<td class=\"digest\">" + html_escape(file.digest) + "</td></tr>\n";
  }
  return html;
}

std::string parameters_html(const nlohmann::ordered_json& parameters) {
  std::string html;
  append_parameters("", parameters, html);
  return html;
}

std::string parameters_section_html(const nlohmann::ordered_json& parameters) {
  const std::string rows = parameters_html(parameters);
  if (rows.empty()) return "";
  return "<section aria-labelledby=\"parameters-heading\">\n  <h2 id=\"parameters-heading\">Parameters</h2>\n"
         "  <details><summary>All options of this run</summary>\n  <table class=\"parameters\"><tbody>\n" +
         rows + "</tbody></table></details>\n</section>\n";
}

std::string lat_lon(GeodeticPoint point) {
  return number_text(point.lat_deg, 6) + ", " + number_text(point.lon_deg, 6);
}

std::string lat_lon_dms(GeodeticPoint point) {
  return dms(point.lat_deg, 'N', 'S') + " " + dms(point.lon_deg, 'E', 'W');
}

std::string page_head_html(const std::string& title, bool with_map) {
  const auto leaflet_css = [] { return without_source_map(without_files(std::string(page_assets::leaflet_css()))); };
  return fill_template(page_assets::page_head_html(),
                       {{"page_title", html_escape(title)},
                        {"map_style", with_map ? "<style>" + leaflet_css() + "</style>\n" : ""},
                        {"page_css", std::string(page_assets::page_css())}});
}

std::string kind_mark(NumberKind kind) {
  const auto mark = [](const std::string& word, const std::string& title) {
    return "<span class=\"kind " + word + "\" title=\"" + title + "\">" + word + "</span>";
  };
  switch (kind) {
    case NumberKind::kMeasured:
      return mark("measured", "Measured on the imagery or on flights");
    case NumberKind::kSimulated:
      return mark("simulated", "Counted over computed flights or frames with drawn errors");
    case NumberKind::kModelled:
      return mark("modelled", "Computed by a formula: the inertial error model, or a fitted P");
    case NumberKind::kStated:
      break;
  }
  return "";
}

std::string figure_html(const std::string& label, const std::string& value, const std::string& detail,
                        const std::string& mark) {
  return "    <div><dt>" + html_escape(label) + "</dt><dd><b>" + html_escape(value) + "</b> <span>" +
         html_escape(detail) + "</span>" + (mark.empty() ? "" : " " + mark) + "</dd></div>\n";
}

std::string map_row_html(std::string_view label, const std::vector<MapLayer>& layers) {
  std::string boxes;
  for (const MapLayer& layer : layers) {
    boxes += "          <label><input type=\"checkbox\" id=\"show-" + std::string(layer.name) + "\"" +
             (layer.shown ? " checked" : "") + "> " + html_escape(layer.label) + "</label>\n";
  }
  return fill_template(page_assets::map_row_html(), {{"map_label", html_escape(label)}, {"layers", boxes}});
}

std::string sketch_section_html(const std::string& differs) {
  return fill_template(page_assets::sketch_html(),
                       {{"modelled", kind_mark(NumberKind::kModelled)}, {"differs", html_escape(differs)}});
}

std::string page_leaflet_js() {
  return without_source_map(std::string(page_assets::leaflet_js()));
}

std::string page_script(std::initializer_list<std::string_view> parts) {
  std::string script = "(function () {\n'use strict';\n";
  for (const std::string_view part : parts) script += part;
  return script + "}());\n";
}

}  // namespace pilotage
