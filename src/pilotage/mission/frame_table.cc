#include "pilotage/mission/frame_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kAny = std::numeric_limits<double>::max();

/// The numbers of a row, in the order of kColumns.
enum Column : std::size_t {
  kTime,
  kPriorLon,
  kPriorLat,
  kPriorSigma,
  kPriorEastSigma,
  kPriorNorthSigma,
  kPriorCovariance,
  kHeight,
  kYaw,
  kPitch,
  kRoll,
  kTrueLon,
  kTrueLat,
  kNadirLon,
  kNadirLat,
  kColumnCount,
};
using Numbers = std::array<double, kColumnCount>;

struct ColumnRule {
  const char* name;
  Range range;
  bool is_truth = false;
};

constexpr std::array<ColumnRule, kColumnCount> kColumns{{{"time_s", {-kAny, kAny}},
                                                         {"prior_lon_deg", {-180, 360}},
                                                         {"prior_lat_deg", {-90, 90}},
                                                         {"prior_sigma_m", {0, 100000}},
                                                         {"prior_east_sigma_m", {0, 100000}},
                                                         {"prior_north_sigma_m", {0, 100000}},
                                                         {"prior_covariance_en_m2", {-1e10, 1e10}},
                                                         {"height_agl_m", {-1000, 100000}},
                                                         {"yaw_deg", {-360, 360}},
                                                         {"pitch_deg", {-360, 360}},
                                                         {"roll_deg", {-360, 360}},
                                                         {"true_lon_deg", {-180, 360}, true},
                                                         {"true_lat_deg", {-90, 90}, true},
                                                         {"true_nadir_lon_deg", {-180, 360}, true},
                                                         {"true_nadir_lat_deg", {-90, 90}, true}}};

/// How sure the prior is, when it is not the same in every direction; instead of kPriorSigma.
constexpr std::array<Column, 3> kPriorEllipse{kPriorEastSigma, kPriorNorthSigma, kPriorCovariance};

constexpr int kUnknown = -1;
constexpr int kFile = -2;
constexpr int kNotUsed = -3;

/// What a table may say of the truth besides, for other programs.
constexpr std::array<std::string_view, 4> kNotUsedNames{"true_yaw_deg", "true_pitch_deg", "true_roll_deg",
                                                        "true_height_agl_m"};

struct Header {
  std::vector<int> columns;  ///< What stands in each column of the file: an index into kColumns, or one of the above.
  FrameColumns required = FrameColumns::kAll;
  bool true_is_nadir = false;  ///< What true_lon_deg and true_lat_deg are.
  std::vector<std::string> warnings;
};

std::vector<std::string> known_names() {
  std::vector<std::string> names{"file"};
  for (const ColumnRule& rule : kColumns) names.emplace_back(rule.name);
  return names;
}

int column_of(const std::string& name) {
  if (name == "file") return kFile;
  if (std::find(kNotUsedNames.begin(), kNotUsedNames.end(), name) != kNotUsedNames.end()) return kNotUsed;
  const auto found =
      std::find_if(kColumns.begin(), kColumns.end(), [&](const auto& rule) { return name == rule.name; });
  return found == kColumns.end() ? kUnknown : static_cast<int>(found - kColumns.begin());
}

Header read_header(const CsvTable& table, const FrameTableOptions& options) {
  const std::vector<std::string>& names = table.columns();
  Header header;
  header.required = options.required;
  for (const std::string& name : names) {
    header.columns.push_back(column_of(name));
    if (header.columns.back() != kUnknown) continue;
    const std::string nearest = nearest_word(name, known_names());
    const bool misspelt = !nearest.empty() && std::find(names.begin(), names.end(), nearest) == names.end();
    header.warnings.push_back(table.where() + "column \"" + name + "\" is not known and not used" +
                              (misspelt ? "; is it \"" + nearest + "\"?" : ""));
  }
  const auto has = [&](int column) {
    return std::find(header.columns.begin(), header.columns.end(), column) != header.columns.end();
  };
  header.true_is_nadir = options.truth == FrameTruth::kNadir && !has(kNadirLon) && !has(kNadirLat);
  const auto need = [&](int column, const std::string& name) {
    if (has(column)) return;
    throw DataError(table.where() + "column \"" + name + "\" is missing; the columns are " + join(names, ", "));
  };
  need(kFile, "file");
  const bool ellipse = std::any_of(kPriorEllipse.begin(), kPriorEllipse.end(), has);
  if (ellipse && has(kPriorSigma)) {
    throw DataError(table.where() + "columns \"prior_sigma_m\" and \"prior_east_sigma_m\" … exclude each other");
  }
  for (const Column column : kPriorEllipse) {
    if (ellipse) need(column, kColumns[column].name);
  }
  for (std::size_t i = 0; i < kColumns.size() && options.required == FrameColumns::kAll; ++i) {
    const auto column = static_cast<Column>(i);
    const bool of_ellipse = std::find(kPriorEllipse.begin(), kPriorEllipse.end(), column) != kPriorEllipse.end();
    if (kColumns[i].is_truth || of_ellipse || (ellipse && column == kPriorSigma)) continue;
    need(static_cast<int>(i), kColumns[i].name);
  }
  return header;
}

double read_number(const CsvTable& table, const ColumnRule& rule, const std::string& cell, bool required) {
  if (cell.empty() && !required) return kNaN;
  const std::optional<double> value = parse_number(cell);
  if (value && *value >= rule.range.min && *value <= rule.range.max) return *value;
  const bool any = rule.range.max == kAny;
  throw DataError(table.where() + rule.name + " = \"" + cell.substr(0, 40) + "\" is not a number" +
                  (any ? "" : " in [" + format_number(rule.range.min) + ", " + format_number(rule.range.max) + "]"));
}

std::optional<GeodeticPoint> read_truth(const CsvTable& table, const Numbers& numbers, Column lon, Column lat) {
  const bool lon_given = !std::isnan(numbers[lon]);
  if (lon_given != !std::isnan(numbers[lat])) {
    throw DataError(table.where() + kColumns[lon_given ? lon : lat].name + " is given, " +
                    kColumns[lon_given ? lat : lon].name + " is not");
  }
  if (!lon_given) return std::nullopt;
  return GeodeticPoint{wrap_lon_deg(numbers[lon]), numbers[lat]};
}

/// NaN where the row says nothing.
Eigen::Matrix2d read_prior_covariance(const CsvTable& table, const Numbers& numbers) {
  const double sigma_m = numbers[kPriorSigma];
  if (!std::isnan(sigma_m)) return isotropic_covariance_m2(sigma_m);
  const double east_m = numbers[kPriorEastSigma];
  const double north_m = numbers[kPriorNorthSigma];
  const double shared_m2 = numbers[kPriorCovariance];
  try {
    return prior_covariance(east_m, north_m, shared_m2);
  } catch (const UsageError& error) {
    throw DataError(table.where() + error.what());
  }
}

FrameRecord read_row(const CsvTable& table, const Header& header, const std::vector<std::string>& cells) {
  FrameRecord frame;
  Numbers numbers;
  numbers.fill(kNaN);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (header.columns[i] == kFile) frame.file = cells[i];
    if (header.columns[i] < 0) continue;
    const auto column = static_cast<std::size_t>(header.columns[i]);
    const bool needed = header.required == FrameColumns::kAll && !kColumns[column].is_truth;
    numbers[column] = read_number(table, kColumns[column], cells[i], needed);
  }
  if (frame.file.empty()) throw DataError(table.where() + "file is empty");
  frame.time_s = numbers[kTime];
  frame.prior = {std::isnan(numbers[kPriorLon]) ? kNaN : wrap_lon_deg(numbers[kPriorLon]), numbers[kPriorLat]};
  frame.prior_covariance_en_m2 = read_prior_covariance(table, numbers);
  frame.height_agl_m = numbers[kHeight];
  frame.attitude = {numbers[kYaw], numbers[kPitch], numbers[kRoll]};
  frame.true_nadir = read_truth(table, numbers, kNadirLon, kNadirLat);
  (header.true_is_nadir ? frame.true_nadir : frame.true_center) = read_truth(table, numbers, kTrueLon, kTrueLat);
  return frame;
}

}  // namespace

Eigen::Matrix2d prior_covariance(double east_sigma_m, double north_sigma_m, double covariance_en_m2) {
  if (std::abs(covariance_en_m2) > east_sigma_m * north_sigma_m) {
    throw UsageError("prior_covariance_en_m2 = " + format_number(covariance_en_m2) +
                     " is more than prior_east_sigma_m times prior_north_sigma_m, " +
                     format_number(east_sigma_m * north_sigma_m));
  }
  Eigen::Matrix2d covariance;
  covariance << east_sigma_m * east_sigma_m, covariance_en_m2, covariance_en_m2, north_sigma_m * north_sigma_m;
  return covariance;
}

FrameTable frame_table_from_csv(const std::string& name, std::string_view text, const FrameTableOptions& options) {
  CsvTable table(name, text, "a table of frames");
  const Header header = read_header(table, options);
  FrameTable result;
  result.warnings = header.warnings;
  while (const auto* cells = table.next()) result.frames.push_back(read_row(table, header, *cells));
  if (result.frames.empty()) throw DataError(name + ": has no frame, only a line of names");
  return result;
}

std::string frame_path(const std::string& table_path, const std::string& file) {
  return (std::filesystem::path(table_path).parent_path() / file).string();
}

}  // namespace pilotage
