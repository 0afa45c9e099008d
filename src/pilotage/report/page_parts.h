#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/ground/ground.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/verdict/quality.h"

// Pieces of HTML that the pages of a route and of an area share; text is escaped here.

namespace pilotage {

std::string cell_html(const std::string& text);
/// On a small screen a row becomes a card, in which each value says what it is.
std::string cell_html(const std::string& label, const std::string& text);
std::string heading_html(const std::string& text);  ///< Of a row.

/// A table that scrolls where it is too wide. `label` says what it is of; heads are markup, rows are rows.
std::string table_html(const std::string& label, const std::vector<std::string>& heads, const std::string& rows);

std::string badge_html(std::string_view status);
std::string badge_cell_html(std::string_view status);
/// Rows: what, value, status, threshold, advice; a star behind what decides.
std::string quality_rows_html(const std::vector<QualityRow>& rows);

/// Items of a list; "None." without one.
std::string list_html(const std::vector<std::string>& texts);
/// Labels and values of the title block.
std::string title_block_html(const std::vector<std::pair<std::string, std::string>>& block);
std::string imagery_html(const std::vector<ImageryDataset>& imagery);  ///< Rows: imagery, date, GSD, CRS, size.
std::string inputs_html(const std::vector<InputFile>& inputs);         ///< Rows: input, name, date, licence, digest.
/// Rows of all options; nested ones have dotted names, as in a configuration file.
std::string parameters_html(const nlohmann::ordered_json& parameters);
/// The section of all options of a run; nothing where they are not known.
std::string parameters_section_html(const nlohmann::ordered_json& parameters);

/// "53.123456, 7.123456": latitude first, as planners write it.
std::string lat_lon(GeodeticPoint point);
/// The same in degrees, minutes and seconds.
std::string lat_lon_dms(GeodeticPoint point);

/// The beginning of every page, without "</head>": its title (text), the style sheet, and Leaflet's for a map.
std::string page_head_html(const std::string& title, bool with_map);

/// A word behind a heading or a number, with what it means as its title; "" for kStated.
std::string kind_mark(NumberKind kind);

/// A key figure of the headline. `mark`: kind_mark() or nothing.
std::string figure_html(const std::string& label, const std::string& value, const std::string& detail,
                        const std::string& mark = "");

/// A layer of the map that can be hidden. `name`: the script knows it by "show-" and this; `label` is text.
struct MapLayer {
  std::string_view name;
  std::string_view label;
  bool shown = true;
};
/// The map, the tile looked at, and beside them heat map, scale and layers. `label` says what the map is of.
std::string map_row_html(std::string_view label, const std::vector<MapLayer>& layers);

/// The section in which a route is drawn on the map (page_sketch.js). `differs` says how far P of `prepare` lies from
/// its.
std::string sketch_section_html(const std::string& differs);

/// Leaflet's script, without what would make a browser ask for another file.
std::string page_leaflet_js();
/// A page's scripts, joined in one scope of their own.
std::string page_script(std::initializer_list<std::string_view> parts);

}  // namespace pilotage
