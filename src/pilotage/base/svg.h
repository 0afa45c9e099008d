#pragma once

#include <string>
#include <string_view>

namespace pilotage {

/// Elements of an SVG drawing as text. `type` is the class that a style sheet knows; texts and titles are escaped.
struct SvgWriter {
  int decimals = 1;  ///< Of coordinates.

  std::string number(double value) const;
  std::string line(std::string_view type, double x1, double y1, double x2, double y2) const;
  /// `attributes` stand behind the position as they are, with a blank before each.
  std::string text(std::string_view type, double x, double y, std::string_view content,
                   std::string_view attributes = "") const;
  /// `title` is what a pointer over it shows; none when empty.
  std::string rect(std::string_view type, double x, double y, double width, double height,
                   std::string_view title = "") const;
};

/// For the scale of a drawing: the largest of 1, 2, 5, 10 … times a power of ten that is not above `most`, which is
/// positive.
double round_below(double most);

}  // namespace pilotage
