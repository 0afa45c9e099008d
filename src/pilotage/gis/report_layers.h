#pragma once

#include <vector>

#include "pilotage/raster/gdal_vector.h"
#include "pilotage/report/report.h"

namespace pilotage {

/// A report as layers of a map (schemas/report-layers.md). Every number is the very number of report.json, so that the
/// files cannot disagree; geometry comes from the plan. Each layer has its style for QGIS and for KML.
struct ReportLayers {
  VectorLayer decision;  ///< Outlines of the ground of one class (tile_class.h), in the mission grid's CRS.
  VectorLayer tiles;  ///< The cell of every tile, with all columns of report.json's tiles, in the mission grid's CRS.
  VectorLayer areas;  ///< Outlines of the matching areas: selected cells of a level that touch along edges, joined.
  VectorLayer legs;   ///< WGS 84, as gaps and route.
  VectorLayer gaps;
  VectorLayer denied;  ///< Where GNSS is denied; without a feature, and left out of the files, where nothing says so.
  VectorLayer landmarks;  ///< Points, WGS 84; as `denied` where the map has none.
  VectorLayer route;
  VectorLayer report;  ///< Without a shape: the verdict and what the report was made of, as keys and values.
};

/// The report's waypoints, at most kMostWaypointsListed, named by the numbers that the planning program shows for its
/// items. For KML alone.
VectorLayer waypoint_layer(const Report& report);

/// The layers that have a place in files, in their order: all with a shape but an empty `denied` and `landmarks`.
std::vector<const VectorLayer*> drawn_layers(const ReportLayers& layers);

/// `report` is make_report(input). Features come in the order of report.json; route is
/// empty when the plan has no route.
ReportLayers report_layers(const ReportInput& input, const Report& report);

}  // namespace pilotage
