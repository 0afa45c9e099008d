#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/mission/simulation.h"
#include "pilotage/report/report.h"

namespace pilotage {

/// A section of the page for each simulation.
std::string simulation_html(const Report& report);

/// For the page: at each mark distance, CEP50, R95, share within the limit so far, of the first simulation.
nlohmann::ordered_json simulated_marks_json(const Report& report);

/// Ellipses of the true places of 95 of 100 flights, on the ground, at each of the marks of the first
/// simulation that has one.
std::vector<std::vector<GeodeticPoint>> true_place_outlines(const ReportInput& input);

/// Adds the simulation that was read of file `name`, drawn fixes before frames. Throws DataError when it is of another
/// plan, table or selection than those (digests of input_file()), or where one of its kind is there already.
void add_simulation(ReportInput& input, Simulation simulation, const std::string& name,
                    const std::vector<InputFile>& of);

}  // namespace pilotage
