#include "pilotage/report/plan_report.h"

#include <limits>
#include <memory>

#include "pilotage/ground/ground_imagery.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

constexpr int kOverviewSide_px = 1600;

}  // namespace

std::function<GeodeticPoint(Eigen::Vector2d)> geodetic_from_map_of(const Crs& crs) {
  const auto transform = std::make_shared<CrsTransform>(crs);
  return [transform](const Eigen::Vector2d& point) {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    return transform->geodetic_from_map(point).value_or(GeodeticPoint{kNowhere, kNowhere});
  };
}

ReportInput make_report_input(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                              const std::vector<InputFile>& inputs, const std::string& software_version) {
  ReportInput input;
  input.mission = mission;
  input.scores = scores;
  input.selection = selection;
  input.geodetic_from_map = geodetic_from_map_of(mission.ground.crs);
  input.inputs = inputs;
  input.assumptions = mission.notes;
  input.software_version = software_version;
  return input;
}

void add_pictures(ReportInput& input, int threads, const Progress& progress, const OpenLevel& second_date,
                  const OpenLevel& own_imagery) {
  const Mission& mission = input.mission;
  input.imagery = read_overview(mission.ground, kOverviewSide_px);
  input.pictures = read_tile_pictures(mission.ground, threads, progress);
  const OpenLevel shown = second_date ? second_date : own_imagery ? own_imagery : open_own_imagery(mission);
  input.seen = render_seen_frames(mission, shown, threads, progress);
  input.seen.second_date = static_cast<bool>(second_date);
}

}  // namespace pilotage
