#pragma once

#include <string_view>

/// The page of a captured map, embedded at build time.
namespace pilotage::page_assets {

std::string_view quality_html();

}  // namespace pilotage::page_assets
