#include "pilotage/ground/imagery_months.h"

#include <algorithm>
#include <cmath>

namespace pilotage {

double months_between(UtcTime from, UtcTime to) {
  constexpr double kSecondsPerMonth = 365.2425 / 12 * 86400;
  return static_cast<double>((to - from).count()) / kSecondsPerMonth;
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

}  // namespace pilotage
