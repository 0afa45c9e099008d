#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/simulation.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {

// What a verdict rests on. A flight that was flown says more than one whose frames were computed, that more than one
// whose fixes were drawn, and that more than the model; the verdict is the lowest that any of them allows.

/// The line of the quality table. It decides: bad where fewer fixes came than even the level of the place lets expect
/// (z_with_level below −3); marginal below −2, where z is below −3, and where the exact 95 % interval of the share of
/// false fixes lies above the rate that the plan reckons with. More fixes than predicted are good.
QualityRow flown_row(const FlownAgainstPlan& flown, const Selection& selection);

/// How the simulated flights judge the plan: bad when even the upper end of the interval of their share does not reach
/// the probability asked for; good when its lower end does, or, where the matcher answered to frames and flights are
/// few, the share itself. Decides where the plan has a probability.
QualityRow simulated_row(const Simulation& simulation, const Selection& selection);

/// "912 of 1000 flights"
std::string flights_of(const Share& share);

/// Whose frames the matcher answered to: "frames of later.tif".
std::string frames_of_text(const Simulation& simulation);

/// Where most flights are lost: a sentence on the stretch between two marks.
std::string most_lost_text(const Simulation& simulation);

/// The rows that the verdict rests on, strongest first: flown, rendered, drawn, modelled; those that are there.
std::vector<const QualityRow*> evidence_rows(const std::vector<QualityRow>& rows);

/// The strongest row that is bad where a weaker one of `evidence_rows` is not: it contradicts what the plan rests on.
/// nullptr without one.
const QualityRow* contradiction(const std::vector<QualityRow>& rows);

/// "not there: flown flights, frames of another date": what stronger evidence than the model is missing; "" where none
/// is.
std::string missing_evidence(const std::vector<QualityRow>& rows);

/// One line for each kind, strongest first: what it says and how good that is, or how to get it.
std::vector<std::string> evidence_lines(const std::vector<QualityRow>& rows);

/// The same in one line, for the end of a run: "evidence, strongest first: flown none; rendered none; drawn 0.927
/// [0.915, 0.938] … (good); modelled 0.940 ≥ 0.900 … (marginal)".
std::string evidence_line(const std::vector<QualityRow>& rows);

}  // namespace pilotage
