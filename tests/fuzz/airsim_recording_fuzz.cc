// Any bytes as an AirSim recording: DataError, or a log whose numbers can be and whose times are in order.
#include <string>

#include "fuzz/fuzz_targets.h"
#include "fuzz/vehicle_log_checks.h"

#include "pilotage/base/error.h"
#include "pilotage/vehiclelog/log_readers.h"

namespace pilotage {

void fuzz_airsim_recording(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    check_vehicle_log(parse_airsim_recording("fuzz", bytes, {{16.5, 55.5}, 100}), size);
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
