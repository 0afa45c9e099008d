// Any bytes as a telemetry log: DataError, or a log whose numbers can be and whose times are in order.
#include <string>

#include "fuzz/fuzz_targets.h"
#include "fuzz/vehicle_log_checks.h"

#include "pilotage/base/error.h"
#include "pilotage/vehiclelog/log_readers.h"

namespace pilotage {

void fuzz_telemetry(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    check_vehicle_log(parse_telemetry_log("fuzz", bytes), size);
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
