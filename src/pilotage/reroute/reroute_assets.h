#pragma once

#include <string_view>

/// The page of a line that was sought, embedded at build time.
namespace pilotage::page_assets {

std::string_view reroute_html();

}  // namespace pilotage::page_assets
