#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pilotage/ground/measure_scale.h"
#include "pilotage/raster/gdal_write.h"

namespace pilotage {

// Styles for QGIS 3 (.qml): what stands beside a raster under its name, or in a GeoPackage's layer_styles, is applied
// when the layer is opened. Old property elements (<prop>) are written because every QGIS 3 reads them.

/// A band as heat map: single-band pseudocolour over the measure's scale in its colour map, with its unit in the
/// legend.
std::string qgis_heat_style(const MeasureScale& scale, int band);

/// A paletted band: class i is the value i.
std::string qgis_class_style(const std::vector<RasterClass>& classes);

/// The style with names for people for its columns, by name and title, as QGIS shows them in tables and forms.
std::string with_aliases(const std::string& style, const std::vector<std::pair<std::string, std::string>>& titles);

/// The classes of a measure in which tiles are coloured: five of equal width over its scale.
struct ScaleClass {
  double low = 0;
  double high = 0;
  Rgb color;
  std::string label;  ///< "0.20 – 0.40"; with the unit.
};
std::vector<ScaleClass> scale_classes(const MeasureScale& scale);

/// Polygons with the column of the measure, coloured by scale_classes, hatched where it is NULL; with `selection` those
/// whose column "selected" is true have a strong outline.
std::string qgis_tile_style(const MeasureScale& scale, bool selection);

/// An outline without a fill.
std::string qgis_outline_style(Rgb color, double width_mm);

/// A ring with a white rim.
std::string qgis_point_style(Rgb color, double size_mm);

/// Polygons by the text column `column`, one colour for each value.
struct FillClass {
  std::string value;
  std::string label;
  Rgb color;
};
std::string qgis_fill_style(const std::string& column, const std::vector<FillClass>& classes);

/// Lines by the text column `column`, one colour and dash for each value.
struct LineClass {
  std::string value;
  std::string label;
  Rgb color;
  double width_mm = 1;
  bool dashed = false;
};
std::string qgis_line_style(const std::string& column, const std::vector<LineClass>& classes);

}  // namespace pilotage
