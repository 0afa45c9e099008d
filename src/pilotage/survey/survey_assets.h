#pragma once

#include <string_view>

/// The files that the page of a survey has besides those of a report's, embedded at build time.
namespace pilotage::page_assets {

std::string_view survey_html();
std::string_view survey_squares_js();

}  // namespace pilotage::page_assets
