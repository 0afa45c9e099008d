#pragma once

#include <string_view>

/// The files the page is made of, embedded at build time (cmake/embed_files.cmake).
namespace pilotage::page_assets {

std::string_view page_html();
std::string_view page_css();
std::string_view page_head_html();        ///< Of every page.
std::string_view page_appearance_html();  ///< Of every page: light, dark, sunlight.
std::string_view map_row_html();          ///< Of both pages: the map, the tile looked at, and what is set beside it.
std::string_view sketch_html();           ///< The section of both pages in which a route is drawn.
/// The scripts that are joined, in this order, into the page's own.
std::string_view page_base_js();
std::string_view page_state_js();
std::string_view page_ground_js();
std::string_view page_canvas_js();
std::string_view page_grid_js();
std::string_view page_map_js();
std::string_view page_tile_js();
std::string_view page_panel_js();
std::string_view page_curve_js();
std::string_view page_chart_js();
std::string_view page_seen_js();
std::string_view page_ins_js();
std::string_view page_flight_js();
std::string_view page_verdict_js();
std::string_view page_about_js();
std::string_view page_what_if_js();
std::string_view page_geodesic_js();
std::string_view page_sketch_flight_js();
std::string_view page_sketch_files_js();
std::string_view page_sketch_read_js();
std::string_view page_sketch_js();
std::string_view page_fold_js();
std::string_view page_start_js();
std::string_view leaflet_css();
std::string_view leaflet_js();

}  // namespace pilotage::page_assets
