#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/mission/simulation.h"
#include "pilotage/report/quality.h"
#include "pilotage/report/report.h"

namespace pilotage {

/// How the simulated flights judge the plan: good when the lower end of their interval reaches the probability asked
/// for, bad when even the upper end does not. Decides where the plan has a probability.
QualityRow simulated_row(const Simulation& simulation, const Selection& selection);

/// "simulated: 928 of 1,000 flights stay within …": beside the plan's answer; "" without a simulation.
std::string simulated_answer(const Report& report);

/// The section of the page; "" without a simulation.
std::string simulation_html(const Report& report);

/// For the page: at each mark distance, CEP50, R95, share within the limit so far. Empty without a simulation.
nlohmann::ordered_json simulated_marks_json(const Report& report);

/// Ellipses of the true places of 95 of 100 flights, on the ground, at each of the marks that has one.
std::vector<std::vector<GeodeticPoint>> true_place_outlines(const ReportInput& input);

/// Throws DataError when the simulation is of another plan, table or selection than those (digests of input_file()).
void refuse_other_simulation(const Simulation& simulation, const std::string& name, const std::vector<InputFile>& of);

}  // namespace pilotage
