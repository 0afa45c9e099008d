#pragma once

#include <string>
#include <string_view>

#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {

// A reader for each format; what they throw and count says parse_vehicle_log().

/// PX4's ULog (docs.px4.io, "ULog File Format").
VehicleLog parse_ulog(const std::string& name, std::string_view bytes);
bool is_ulog(std::string_view bytes);

/// ArduPilot's DataFlash log (ArduPilot, libraries/AP_Logger).
VehicleLog parse_dataflash_log(const std::string& name, std::string_view bytes);
bool is_dataflash_log(std::string_view bytes);

/// A ground station's telemetry log: frames of MAVLink 1 and 2, each behind eight bytes of time.
VehicleLog parse_telemetry_log(const std::string& name, std::string_view bytes);
bool is_telemetry_log(std::string_view bytes);

/// AirSim's recording, airsim_rec.txt.
VehicleLog parse_airsim_recording(const std::string& name, std::string_view text, const LogOrigin& origin);
bool is_airsim_recording(std::string_view text);

}  // namespace pilotage
