#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/report/report.h"

namespace pilotage {

/// The version of report.json that this program writes and reads.
inline constexpr int kReportFormatVersion = 2;

/// Reads a report.json: what report_json() wrote, but for the columns of tiles beyond place, selection and
/// P(correct fix), the measures, the error profile, weak places and pictures. Throws DataError, beginning with the
/// file's name, for what is no JSON, no report of ours, a report of another format version, or lacks something.
Report read_report(const std::filesystem::path& path);

/// read_report of what is JSON already; `file` is what messages call it.
Report report_from_json(const nlohmann::ordered_json& json, const std::string& file);

/// The part `grid` of report.json.
nlohmann::ordered_json grid_json(const Report& report);

/// The parts `grid.levels`, `imagery` and `inputs`.
nlohmann::ordered_json levels_json(const std::vector<GridLevel>& levels);
nlohmann::ordered_json imagery_json(const std::vector<ImageryDataset>& imagery);
nlohmann::ordered_json inputs_json(const std::vector<InputFile>& inputs);

}  // namespace pilotage
