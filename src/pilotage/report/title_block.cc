#include "pilotage/report/title_block.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pilotage/base/source_date.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/mission/flight_time.h"

namespace pilotage {
namespace {

/// The least and the largest finite value.
template <class Value>
std::optional<std::pair<double, double>> range_of(const std::vector<FlightSample>& samples, const Value& value) {
  std::optional<std::pair<double, double>> range;
  for (const FlightSample& sample : samples) {
    const double next = value(sample);
    if (!std::isfinite(next)) continue;
    range = range ? std::pair(std::min(range->first, next), std::max(range->second, next)) : std::pair(next, next);
  }
  return range;
}

/// "18 m/s", "12 to 18 m/s"
std::string range_text(const std::pair<double, double>& range, int decimals, const std::string& unit) {
  const std::string low = number_text(range.first, decimals);
  const std::string high = number_text(range.second, decimals);
  return (low == high ? low : low + " to " + high) + " " + unit;
}

/// The name of the camera that the route file names, where that is the one that flies; "" otherwise.
std::string camera_name(const Flight& flight) {
  if (!flight.route.camera) return "";
  const Camera named = make_camera({}, flight.route.camera);
  const Camera& flown = flight.camera;
  const bool same = named.width_px == flown.width_px && named.height_px == flown.height_px &&
                    named.fx_px == flown.fx_px && named.fy_px == flown.fy_px;
  return same ? flight.route.camera->name : "";
}

std::string camera_words(const Flight& flight) {
  const Camera& camera = flight.camera;
  const double width_deg = 2 * std::atan(camera.width_px / 2.0 / camera.fx_px) * 180 / std::numbers::pi;
  std::string text = camera_name(flight);
  text += (text.empty() ? "" : ", ") + std::to_string(camera.width_px) + " × " + std::to_string(camera.height_px) +
          " px, " + number_text(width_deg, 1) + "° wide";
  return text;
}

std::string imagery_words(const Imagery& imagery) {
  std::vector<std::string> dates;
  for (const ImageryDataset& raster : imagery.datasets) {
    const std::string date = raster.acquired.empty() ? "date not known" : raster.acquired;
    if (std::find(dates.begin(), dates.end(), date) == dates.end()) dates.push_back(date);
  }
  std::sort(dates.begin(), dates.end());
  return join(dates, ", ");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> title_block(const ReportInput& input) {
  const Mission& mission = input.mission;
  const std::vector<FlightSample>& samples = mission.flight.samples;
  std::vector<std::pair<std::string, std::string>> block;
  if (const auto made = source_date()) block.emplace_back("Made", format_utc_time(*made));
  if (!mission.ground.flight_time.empty()) block.emplace_back("Flight begins", mission.ground.flight_time + " (UTC)");
  if (const double time_s = flight_time_s(samples); std::isfinite(time_s) && time_s > 0) {
    block.emplace_back("Flight time", duration_text(time_s) + ": length over speed, without wind, climbs and turns");
  }
  if (const auto speed = range_of(samples, [](const FlightSample& sample) { return sample.speed_mps; })) {
    block.emplace_back("Speed", range_text(*speed, 1, "m/s"));
  }
  if (const auto height = range_of(samples, [](const FlightSample& sample) { return sample.agl_m; })) {
    block.emplace_back("Height", range_text(*height, 0, "m above ground"));
  }
  if (mission.flight.camera.fx_px > 0) block.emplace_back("Camera", camera_words(mission.flight));
  if (!mission.ground.imagery.datasets.empty()) block.emplace_back("Imagery", imagery_words(mission.ground.imagery));
  if (!mission.ground.crs.empty()) block.emplace_back("CRS", mission.ground.crs.name());
  for (auto& [label, value] : block) value = valid_utf8(value);
  return block;
}

}  // namespace pilotage
