#include "pilotage/gis/kml_files.h"

#include "pilotage/gis/degree_overlay.h"
#include "pilotage/gis/ground_layers.h"
#include "pilotage/raster/gdal_zip.h"

namespace pilotage {
namespace {

// The route as a whole first, then its parts.
std::vector<VectorLayer> line_layers(const ReportLayers& layers) {
  std::vector<VectorLayer> lines = {layers.route, layers.legs, layers.gaps};
  if (!layers.denied.features.empty()) lines.push_back(layers.denied);
  return lines;
}

}  // namespace

std::string legs_kml(const Report& report, const ReportLayers& layers) {
  return kml_document(report.title, line_layers(layers));
}

std::string route_kml(const Report& report, const ReportLayers& layers) {
  return kml_document(report.title, {layers.route, waypoint_layer(report)});
}

std::string areas_kml(const Report& report, const ReportLayers& layers) {
  return kml_document(report.title, {layers.areas});
}

void write_kmz(const std::filesystem::path& path, const ReportInput& input, const Report& report,
               const ReportLayers& layers, bool overwrite) {
  std::vector<VectorLayer> folders = line_layers(layers);
  folders.insert(folders.begin(), layers.decision);
  folders.push_back(layers.areas);
  if (!layers.landmarks.features.empty()) folders.push_back(layers.landmarks);
  folders.push_back(layers.tiles);
  std::string document = kml_document(report.title, folders);
  DegreeOverlay overlay =
      heat_overlay(ScoreTable(input.mission.ground, input.scores), shown_scale(report.measures), true);
  document.insert(document.rfind("</Document>"), overlay.kml);  // GDAL writes no overlays
  std::vector<std::pair<std::string, std::string>> files{{"doc.kml", std::move(document)}};
  for (auto& picture : overlay.pictures) files.push_back(std::move(picture));
  write_zip(path, files, overwrite);
}

}  // namespace pilotage
