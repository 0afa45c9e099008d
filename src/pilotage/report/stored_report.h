#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/mission/input_files.h"

namespace pilotage {

/// The version of report.json that this program writes and reads.
inline constexpr int kReportFormatVersion = 1;

/// A row of the quality table as a report holds it.
struct StoredQuality {
  std::string name;
  std::string label;
  std::string value;
  std::string status;
};

struct StoredLeg {
  int leg = 0;
  GeodeticPoint from;
  GeodeticPoint to;
  std::string status;
  double max_error_m = 0;     ///< NaN: unknown or unbounded.
  double p_within_limit = 0;  ///< NaN without probabilities.
};

struct StoredTile {
  std::int64_t tile_id = 0;
  int level = 0;
  GeodeticPoint center;
  bool selected = false;
  double p_correct_fix = std::numeric_limits<double>::quiet_NaN();
};

/// What a comparison needs of a report.json.
struct StoredReport {
  std::string file;
  std::string title;
  std::string software_version;
  std::string verdict_status;
  std::string verdict_text;
  std::vector<StoredQuality> quality;
  double route_length_m = 0;
  double matchable_fraction = 0;
  double largest_error_m = 0;
  double max_error_m = 0;
  double p_within_limit = std::numeric_limits<double>::quiet_NaN();
  double expected_fixes = std::numeric_limits<double>::quiet_NaN();
  double expected_false_fixes = std::numeric_limits<double>::quiet_NaN();
  std::int64_t gaps = 0;
  double longest_gap_m = 0;  ///< 0 without gaps.
  double longest_gap_s = 0;
  std::vector<StoredLeg> legs;
  std::vector<int> worst_legs;  ///< Indices into `legs`.
  std::vector<StoredTile> tiles;
  std::int64_t selected_tiles = 0;
  std::int64_t estimated_bytes = 0;
  std::vector<double> stride_m;  ///< Of each level of the grid.
  std::vector<InputFile> inputs;
  nlohmann::ordered_json parameters;
  nlohmann::ordered_json grid;
};

/// Reads a report.json. Throws DataError, beginning with the file's name, for what is no JSON, no report of ours, a
/// report of another format version, or lacks what a comparison needs.
StoredReport read_report(const std::filesystem::path& path);

/// read_report of what is JSON already; `file` is what messages call it.
StoredReport stored_report(const nlohmann::ordered_json& json, const std::string& file);

}  // namespace pilotage
