#include "pilotage/report/plan_report.h"

#include <filesystem>
#include <limits>
#include <memory>
#include <system_error>

#include "pilotage/base/file_digest.h"
#include "pilotage/mission/plan_imagery.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

constexpr int kOverviewSide_px = 1600;

ReportFile describe_file(const std::string& role, const std::string& name, const std::string& date) {
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(name, ignored);
  return {role, name, date, is_file ? "blake2b-256:" + file_digest(name) : ""};
}

}  // namespace

std::vector<ReportFile> input_files(const TilePlan& plan) {
  std::vector<ReportFile> files;
  for (const PlanImagery& imagery : plan.imagery) {
    files.push_back(describe_file("imagery", imagery.dataset, imagery.acquired));
  }
  if (!plan.elevation.empty()) files.push_back(describe_file("elevation", plan.elevation, ""));
  if (!plan.route_file.empty()) files.push_back(describe_file("route", plan.route_file, ""));
  return files;
}

ReportInput make_report_input(const TilePlan& plan, const std::vector<TileScore>& scores, const Selection& selection,
                              const std::string& software_version) {
  ReportInput input;
  input.plan = plan;
  input.scores = scores;
  input.selection = selection;
  input.imagery = read_plan_overview(plan, kOverviewSide_px);
  const auto transform = std::make_shared<CrsTransform>(Crs::from_user_input(plan.crs_wkt));
  input.geodetic_from_map = [transform](Eigen::Vector2d point) {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    return transform->geodetic_from_map(point).value_or(GeodeticPoint{kNowhere, kNowhere});
  };
  input.inputs = input_files(plan);
  input.software_version = software_version;
  return input;
}

}  // namespace pilotage
