#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/compare/compare.h"

namespace pilotage {

/// Where a comparison comes from, for its files.
struct ComparisonSource {
  std::vector<std::string> reference;
  std::string frames;            ///< frames.csv.
  std::string software_version;  ///< "pilotage 0.2.0".
  CompareOptions options;
  std::uint64_t seed = 1;
};

/// A page for people: what was compared, the table, what its columns mean, by which rules. `pictures` are names of
/// image files, one for each of Comparison::pictures, or empty.
std::string comparison_markdown(const Comparison& comparison, const ComparisonSource& source,
                                const std::vector<std::string>& pictures);

/// One line for each method: summary_columns().
std::string comparison_csv(const Comparison& comparison);

/// All of it, frame by frame: schemas/comparison.schema.json.
nlohmann::ordered_json comparison_json(const Comparison& comparison, const ComparisonSource& source);

/// Writes what the name of `output` asks for: NAME.csv and NAME.json that one file; NAME.md all of NAME.md, NAME.csv,
/// NAME.json and a picture for each method, NAME_ORB.png …. All of them appear, or none. Returns what was written.
/// Throws UsageError for any other name, DataError when one exists and `overwrite` is false, or cannot be written.
std::vector<std::filesystem::path> write_comparison(const std::filesystem::path& output, const Comparison& comparison,
                                                    const ComparisonSource& source, bool overwrite);

/// All files that write_comparison may write for a name. Throws UsageError for a name that it refuses.
std::vector<std::filesystem::path> comparison_outputs(const std::filesystem::path& output);

/// Throws as write_comparison would for names, before there is a comparison.
void check_comparison_output(const std::filesystem::path& output, const CompareOptions& options, bool overwrite);

}  // namespace pilotage
