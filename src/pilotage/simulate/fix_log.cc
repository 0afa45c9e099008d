#include "pilotage/simulate/fix_log.h"

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "pilotage/base/csv.h"
#include "pilotage/flightlog/fix_table.h"

namespace pilotage {
namespace {

using TryColumn = std::pair<std::string, std::function<std::string(const SimulatedTry&)>>;

std::vector<TryColumn> try_columns() {
  std::vector<TryColumn> columns;
  const auto number = [&](const std::string& name, const std::function<double(const SimulatedTry&)>& get) {
    columns.emplace_back(name, [get](const SimulatedTry& tried) { return csv_cell(get(tried)); });
  };
  number("flight", [](const SimulatedTry& t) { return static_cast<double>(t.flight); });
  number("sample", [](const SimulatedTry& t) { return static_cast<double>(t.sample); });
  columns.emplace_back("below_tile_id", [](const SimulatedTry& t) {
    return t.below_tile_id ? std::to_string(*t.below_tile_id) : std::string();
  });
  number("below_p_correct_fix", [](const SimulatedTry& t) { return t.below_p; });
  number("true_nadir_lon_deg", [](const SimulatedTry& t) { return t.pose.position.lon_deg; });
  number("true_nadir_lat_deg", [](const SimulatedTry& t) { return t.pose.position.lat_deg; });
  number("true_height_agl_m", [](const SimulatedTry& t) { return t.pose.height_agl_m; });
  number("true_yaw_deg", [](const SimulatedTry& t) { return t.pose.attitude.yaw_deg; });
  number("true_pitch_deg", [](const SimulatedTry& t) { return t.pose.attitude.pitch_deg; });
  number("true_roll_deg", [](const SimulatedTry& t) { return t.pose.attitude.roll_deg; });
  number("prior_lon_deg", [](const SimulatedTry& t) { return t.match.frame.prior.lon_deg; });
  number("prior_lat_deg", [](const SimulatedTry& t) { return t.match.frame.prior.lat_deg; });
  number("prior_east_sigma_m",
         [](const SimulatedTry& t) { return std::sqrt(t.match.frame.prior_covariance_en_m2(0, 0)); });
  number("prior_north_sigma_m",
         [](const SimulatedTry& t) { return std::sqrt(t.match.frame.prior_covariance_en_m2(1, 1)); });
  number("prior_covariance_en_m2", [](const SimulatedTry& t) { return t.match.frame.prior_covariance_en_m2(0, 1); });
  return columns;
}

}  // namespace

std::string fix_log_to_csv(std::span<const SimulatedTry> tries) {
  const std::vector<FixColumn> of_match = fix_columns(false);
  const std::vector<TryColumn> of_try = try_columns();
  std::string text;
  for (const FixColumn& column : of_match) text += (text.empty() ? "" : ",") + column.name;
  for (const TryColumn& column : of_try) text += "," + column.first;
  text += '\n';
  for (const SimulatedTry& tried : tries) {
    std::string line;
    for (const FixColumn& column : of_match)
      line += (&column == of_match.data() ? "" : ",") + column.write(tried.match);
    for (const TryColumn& column : of_try) line += "," + column.second(tried);
    text += line + "\n";
  }
  return text;
}

}  // namespace pilotage
