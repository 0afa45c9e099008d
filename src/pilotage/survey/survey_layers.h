#pragma once

#include <filesystem>

#include "pilotage/ground/score_table.h"
#include "pilotage/survey/survey.h"

namespace pilotage {

// The survey for programs that draw maps (schemas/report-layers.md): the layers decision, squares and tiles, each with
// its style, the decision first.

/// GeoPackage with a table `survey` of the headline and what it rests on as keys and values. `table` is the survey's
/// ground with its scores.
void write_survey_geopackage(const std::filesystem::path& path, const Survey& survey, const ScoreTable& table);

/// KMZ for Google Earth, with a legend and the heat map to switch on; nothing outside the file is asked for.
void write_survey_kmz(const std::filesystem::path& path, const Survey& survey, const ScoreTable& table);

}  // namespace pilotage
