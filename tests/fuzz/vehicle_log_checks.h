#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {

template <class Record>
void require_order(const std::vector<Record>& records, std::size_t size) {
  if (records.size() > size) std::abort();  // no record without bytes
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!std::isfinite(records[i].time_s) || (i > 0 && records[i].time_s < records[i - 1].time_s)) std::abort();
  }
}

/// Aborts when a log of `size` bytes holds what no reader may let through.
inline void check_vehicle_log(const VehicleLog& log, std::size_t size) {
  for (const LoggedTrack* track : {&log.estimate, &log.gnss, &log.truth}) {
    require_order(track->positions, size);
    require_order(track->velocities, size);
    require_order(track->attitudes, size);
    for (const LoggedPosition& position : track->positions) {
      if (!(std::abs(position.point.lat_deg) <= 90 && std::abs(position.point.lon_deg) <= 180)) std::abort();
    }
    for (const LoggedAttitude& record : track->attitudes) {
      if (!std::isfinite(record.attitude.yaw_deg + record.attitude.pitch_deg + record.attitude.roll_deg)) std::abort();
    }
  }
  require_order(log.heights, size);
  require_order(log.captures, size);
  const LogLosses& losses = log.losses;
  if (losses.bytes_skipped < 0 || losses.bytes_skipped > static_cast<std::int64_t>(size)) std::abort();
  if (notes_of_log(log).size() > 20 || !(duration_s(log) >= 0)) std::abort();
}

}  // namespace pilotage
