#include "pilotage/gis/kml_files.h"

#include "pilotage/gis/degree_overlay.h"
#include "pilotage/raster/gdal_zip.h"

namespace pilotage {

std::string legs_kml(const Report& report, const ReportLayers& layers) {
  return kml_document(report.title, {layers.route, layers.legs, layers.gaps});
}

std::string areas_kml(const Report& report, const ReportLayers& layers) {
  return kml_document(report.title, {layers.areas});
}

void write_kmz(const std::filesystem::path& path, const ReportInput& input, const Report& report,
               const ReportLayers& layers, bool overwrite) {
  std::string document =
      kml_document(report.title, {layers.decision, layers.route, layers.legs, layers.gaps, layers.areas, layers.tiles});
  DegreeOverlay overlay = heat_overlay(input, report);
  document.insert(document.rfind("</Document>"), overlay.kml);  // GDAL writes no overlays
  std::vector<std::pair<std::string, std::string>> files{{"doc.kml", std::move(document)}};
  for (auto& picture : overlay.pictures) files.push_back(std::move(picture));
  write_zip(path, files, overwrite);
}

}  // namespace pilotage
