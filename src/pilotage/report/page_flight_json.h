#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "pilotage/ins/ins_options.h"
#include "pilotage/mission/flight_conditions.h"

namespace pilotage {

/// The inertial systems that a page can predict a flight with (page_ins.js): what is planned first, `grade` null, then
/// each grade with the figures of its own that the plan gives. Numbers are those of InsErrorModel.
nlohmann::ordered_json ins_choices_json(const InsOptions& planned, const FlightConditions& conditions);

/// wind_cases() of so many levels of the place, what the P of a route is the mean over: [index of the level, weight at
/// that level, wind east and north in m/s].
nlohmann::ordered_json wind_cases_json(const FlightConditions& conditions, std::size_t levels);

}  // namespace pilotage
