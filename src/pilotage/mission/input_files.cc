#include "pilotage/mission/input_files.h"

#include <filesystem>
#include <system_error>

#include "pilotage/base/file_digest.h"
#include "pilotage/base/utf8.h"
#include "pilotage/raster/gdal_files.h"

namespace pilotage {

InputFile input_file(const std::string& role, const std::string& name, const std::string& date) {
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(name, ignored);
  return {role, name_as_utf8(name), date, is_file ? "blake2b-256:" + file_digest(name) : ""};
}

InputFile input_dataset(const std::string& role, const std::string& name, const std::string& date,
                        const Licence& licence) {
  return {role, name_as_utf8(name), date, dataset_digest(name), licence};
}

std::vector<InputFile> input_files(const Mission& mission) {
  std::vector<InputFile> files;
  for (const ImageryDataset& imagery : mission.ground.imagery.datasets) {
    files.push_back(input_dataset("imagery", imagery.dataset, imagery.acquired, imagery.licence));
  }
  if (!mission.ground.elevation.empty()) {
    files.push_back(input_dataset("elevation", mission.ground.elevation, "", mission.ground.elevation_licence));
  }
  if (!mission.flight.route_file.empty()) files.push_back(input_file("route", mission.flight.route_file, ""));
  for (const std::string& file : mission.flight.denied.files) files.push_back(input_file("denied", file, ""));
  if (mission.flight.ground_hidden) files.push_back(input_file("clouds", mission.flight.ground_hidden->file, ""));
  return files;
}

}  // namespace pilotage
