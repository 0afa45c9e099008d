#pragma once

#include <string>
#include <string_view>

namespace pilotage {

/// Text for the content of HTML, SVG and XML and for attributes in quotes: & < > " ' become entities, control
/// characters other than tab and line feed become U+FFFD.
std::string html_escape(std::string_view text);

}  // namespace pilotage
