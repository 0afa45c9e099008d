#pragma once

#include <string>
#include <vector>

#include "pilotage/report/flight_notes.h"
#include "pilotage/report/quality.h"

namespace pilotage {

// What a verdict rests on. A flight that was flown says more than one whose frames were computed, that more than one
// whose fixes were drawn, and that more than the model; the verdict is the lowest that any of them allows.

/// Throws DataError when the replay was held against a plan with another P than this selection has.
void refuse_other_replay(const ReplayNote& replay, const Selection& selection);

/// The line of the quality table. It decides: bad where fewer fixes came than even the level of the place lets expect
/// (z_with_level below −3); marginal below −2, where z is below −3, and where the exact 95 % interval of the share of
/// false fixes lies above the rate that the plan reckons with. More fixes than predicted are good.
QualityRow flown_row(const FlownAgainstPlan& flown, const Selection& selection);

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
