#pragma once

#include <string_view>

/// The files the page is made of, embedded at build time (cmake/embed_files.cmake).
namespace pilotage::page_assets {

std::string_view page_html();
std::string_view page_css();
std::string_view page_js();
std::string_view leaflet_css();
std::string_view leaflet_js();

}  // namespace pilotage::page_assets
