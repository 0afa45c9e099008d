#pragma once

#include <string>

#include "pilotage/report/report.h"

namespace pilotage {

/// Of the chart and of what is drawn below it along the same axis, in the drawing's own units.
inline constexpr double kChartWidth = 1200;
inline constexpr double kChartLeft = 64;
inline constexpr double kChartRight = 1184;

/// Distance along the route at the chart's right end; positive.
double chart_distance_m(const Report& report);

/// The chart along the route as inline SVG: predicted error with the limit, gaps as bands, legs and stretches over
/// selected tiles as ribbons. Coloured by the page's classes. Its data-* attributes (left, right, top, bottom in its
/// own units, distance_m and error_m at the far ends) let the page's script find a distance under the pointer.
std::string strip_chart_svg(const Report& report);

/// 1, 2 or 5 times a power of ten: the smallest step that cuts `extent` into at most `most` pieces; 1 when extent is
/// not positive.
double tick_step(double extent, int most);

}  // namespace pilotage
