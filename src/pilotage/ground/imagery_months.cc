#include "pilotage/ground/imagery_months.h"

#include <algorithm>
#include <cmath>

namespace pilotage {

namespace {

constexpr double kSecondsPerMonth = 365.2425 / 12 * 86400;

}  // namespace

double months_between(UtcTime from, UtcTime to) {
  return static_cast<double>((to - from).count()) / kSecondsPerMonth;
}

UtcTime months_after(UtcTime time, double months) {
  return time + std::chrono::seconds(std::llround(months * kSecondsPerMonth));
}

std::optional<UtcTime> oldest_imagery(const Ground& ground) {
  std::optional<UtcTime> oldest;
  for (const ImageryDataset& imagery : ground.imagery.datasets) {
    const auto acquired = parse_utc_date(imagery.acquired);
    if (!acquired) return std::nullopt;
    oldest = std::min(oldest.value_or(acquired->time), acquired->time);
  }
  return oldest;
}

std::optional<double> imagery_months(const Ground& ground) {
  const auto flight = parse_utc_date(ground.flight_time);
  if (!flight || ground.imagery.datasets.empty()) return std::nullopt;
  double months = 0;
  for (const ImageryDataset& imagery : ground.imagery.datasets) {
    const auto acquired = parse_utc_date(imagery.acquired);
    if (!acquired) return std::nullopt;
    months = std::max(months, std::abs(months_between(acquired->time, flight->time)));
  }
  return months;
}

std::optional<UtcTime> ageing_imagery(const Ground& ground) {
  const auto oldest = oldest_imagery(ground);
  const auto farthest_months = imagery_months(ground);
  if (!oldest || !farthest_months) return std::nullopt;
  const double months = months_between(*oldest, parse_utc_date(ground.flight_time)->time);
  return months >= *farthest_months ? oldest : std::nullopt;
}

}  // namespace pilotage
