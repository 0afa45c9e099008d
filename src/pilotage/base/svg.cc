#include "pilotage/base/svg.h"

#include <cmath>

#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string element(std::string_view name, std::string_view type) {
  return "<" + std::string(name) + " class=\"" + std::string(type) + "\"";
}

}  // namespace

std::string SvgWriter::number(double value) const {
  const double steps = std::pow(10, decimals);
  return format_number(std::round(value * steps) / steps);
}

std::string SvgWriter::line(std::string_view type, double x1, double y1, double x2, double y2) const {
  return element("line", type) + " x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) +
         "\" y2=\"" + number(y2) + "\"/>\n";
}

std::string SvgWriter::text(std::string_view type, double x, double y, std::string_view content,
                            std::string_view attributes) const {
  return element("text", type) + " x=\"" + number(x) + "\" y=\"" + number(y) + "\"" + std::string(attributes) + ">" +
         html_escape(content) + "</text>\n";
}

std::string SvgWriter::rect(std::string_view type, double x, double y, double width, double height,
                            std::string_view title) const {
  return element("rect", type) + " x=\"" + number(x) + "\" y=\"" + number(y) + "\" width=\"" + number(width) +
         "\" height=\"" + number(height) + "\">" + (title.empty() ? "" : "<title>" + html_escape(title) + "</title>") +
         "</rect>\n";
}

double round_below(double most) {
  const double decade = std::pow(10.0, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= most) return step * decade;
  }
  return decade;
}

}  // namespace pilotage
