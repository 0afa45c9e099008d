#include "pilotage/tile/map_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/raster/map_sigma.h"
#include "pilotage/tile/tile_map_sigma.h"

namespace pilotage {
namespace {

/// The planner's word goes for all tiles, and so into the onboard map; what the imagery says is not asked then.
void take_given_map_sigma(double map_sigma_m, Mission& mission) {
  for (ImageryDataset& image : mission.ground.imagery.datasets) {
    if (image.map_sigma.empty()) continue;
    mission.notes.push_back("Error of the map: " + format_number(map_sigma_m) + " m each axis as given; " +
                            name_as_utf8(image.map_sigma) + " is not asked");
    image.map_sigma.clear();
  }
  for (GroundTile& tile : mission.ground.tiles) tile.map_sigma_m = map_sigma_m;
}

}  // namespace

void add_placement_error(const std::vector<ImageryInfo>& infos, Mission& mission) {
  double rms_m = 0;
  std::string from;
  for (const auto& info : infos) {
    const double raster_m = placement_rms_m(info);
    if (raster_m <= rms_m) continue;
    rms_m = raster_m;
    from = info.datum_accuracy_m == 0 ? "whose place comes from ground control points"
           : info.control_points      ? "whose place comes from ground control points and a change of datum"
                                      : "whose place comes by a change of datum";
  }
  if (rms_m == 0) return;
  double& fix_sigma_m = mission.flight.ins.fix_sigma_m;
  const double with_map_m = std::hypot(fix_sigma_m, rms_m / std::numbers::sqrt2);
  mission.notes.push_back("Error of a fix: " + format_fixed(with_map_m, 2) + " m each axis, of which " +
                          format_fixed(fix_sigma_m, 2) + " m are the matcher's and " +
                          format_fixed(rms_m / std::numbers::sqrt2, 2) + " m the map's, " + from);
  fix_sigma_m = with_map_m;
}

void add_map_sigma(const FlightConditions& given, Mission& mission) {
  FlightConditions& conditions = mission.flight.conditions;
  conditions.map_sigma_m = given.map_sigma_m.value_or(kUnknownMapSigma_m);
  conditions.map_correlation_m = given.map_correlation_m.value_or(kMapCorrelation_m);
  if (given.map_sigma_m) return take_given_map_sigma(*given.map_sigma_m, mission);
  std::vector<std::string> rasters;
  for (const ImageryDataset& image : mission.ground.imagery.datasets) {
    if (image.map_sigma.empty()) continue;
    if (!map_sigma_exists(image.map_sigma)) {
      throw DataError(image.dataset + ": says that its own error stands in " + name_as_utf8(image.map_sigma) +
                      ", which does not exist; put it there, or give --map-sigma-m");
    }
    rasters.push_back(image.map_sigma);
  }
  if (rasters.empty()) return;
  if (!measure_map_sigma(mission.ground)) {
    for (GroundTile& tile : mission.ground.tiles) tile.map_sigma_m.reset();  // of what is seen nothing is said
    for (ImageryDataset& image : mission.ground.imagery.datasets) image.map_sigma.clear();
    return;
  }
  double least_m = std::numeric_limits<double>::infinity();
  double largest_m = 0;
  for (const GroundTile& tile : mission.ground.tiles) {
    if (!tile.map_sigma_m) continue;
    least_m = std::min(least_m, *tile.map_sigma_m);
    largest_m = std::max(largest_m, *tile.map_sigma_m);
  }
  conditions.map_sigma_m = largest_m;
  conditions.map_correlation_m = given.map_correlation_m.value_or(kCommonMapCorrelation_m);
  mission.notes.push_back("Error of the map: " + format_fixed(least_m, 2) + " to " + format_fixed(largest_m, 2) +
                          " m each axis, tile by tile as " + join(rasters, ", ") + " says" +
                          (rasters.size() < mission.ground.imagery.datasets.size()
                               ? ", " + format_number(kUnknownMapSigma_m) + " m of imagery that says nothing"
                               : "") +
                          "; along the route the largest counts");
}

}  // namespace pilotage
