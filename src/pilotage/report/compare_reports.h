#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/report/report.h"

// What changed between two plans, from their report.json: `pilotage report --compare a.json b.json`.

namespace pilotage {

/// Something that both reports say: index 0 is the first report, 1 the second.
template <class Value>
using Both = std::array<Value, 2>;

struct ComparedNumber {
  std::string name;   ///< "p_within_limit"
  std::string label;  ///< For people.
  std::string unit;   ///< "" for none.
  int decimals = 2;
  Both<double> values{};  ///< NaN: not known.
};

struct ComparedQuality {
  std::string name;
  std::string label;
  Both<std::string> values;
  Both<std::string> statuses;  ///< "" in a report without this row.
};

/// A leg that both routes have: from and to agree in five decimals of a degree, about a metre; of legs that a route has
/// several times the first goes with the first.
struct ComparedLeg {
  Both<int> legs{};  ///< Numbers, from 1.
  GeodeticPoint from;
  GeodeticPoint to;
  Both<std::string> statuses;
  Both<double> p_within_limit{};
  Both<double> max_error_m{};
  Both<bool> among_worst{};
};

/// A place at which one of the plans has a matching area.
struct ComparedArea {
  int level = 0;
  GeodeticPoint center;
  Both<std::optional<std::int64_t>> tile_ids;  ///< Nothing where that plan has no tile at this place.
  Both<double> p_correct_fix{};
};

/// A key with what both say; null where one says nothing.
struct ComparedEntry {
  std::string name;  ///< "camera.hfov_deg"; of an input its role, "imagery", "imagery 2".
  Both<nlohmann::ordered_json> values;
};

struct ReportComparison {
  Both<std::string> files;
  Both<std::string> titles;
  Both<std::string> software_versions;
  bool same = false;  ///< Nothing that is compared differs.
  Both<std::string> verdict_statuses;
  Both<std::string> verdict_texts;
  std::vector<ComparedNumber> numbers;   ///< Always the same ones, in the same order.
  std::vector<ComparedQuality> quality;  ///< Rows that differ.
  std::int64_t common_legs = 0;
  std::vector<ComparedLeg> legs;  ///< Common legs that differ, worst of the second report first.
  Both<std::vector<int>> legs_of_one;
  std::int64_t kept_areas = 0;
  std::vector<ComparedArea> added;    ///< Ascending tile_id of the second plan.
  std::vector<ComparedArea> removed;  ///< Ascending tile_id of the first plan.
  std::vector<ComparedArea> changed;  ///< Kept with another P: the largest change first, then ascending tile_id.
  std::vector<ComparedEntry> inputs;
  std::vector<ComparedEntry> parameters;
  std::vector<ComparedEntry> grid;
  std::vector<std::string> notes;  ///< What could not be compared, and why.
};

/// Tiles are paired by place, one to one and nearest first, up to 0.71 strides apart (half the diagonal of a cell), so
/// that plans on different grids can be compared; a note tells when they are. P counts as changed from 0.01 on. `files`
/// are what messages call the reports. Reads what read_report() gives.
ReportComparison compare_reports(const Report& a, const Report& b, const Both<std::string>& files);

/// schemas/report-comparison.schema.json
nlohmann::ordered_json report_comparison_json(const ReportComparison& comparison);

/// For people; at most ten lines of each kind.
std::string report_comparison_text(const ReportComparison& comparison);

}  // namespace pilotage
