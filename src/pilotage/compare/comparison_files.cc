#include "pilotage/compare/comparison_files.h"

#include <cmath>
#include <memory>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/compare/comparison_summary.h"
#include "pilotage/compare/match_picture.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

std::string title(DescriptorMethod method) {
  return std::string(descriptor_method_title(method));
}

Json outcome_json(DescriptorMethod method, const MethodOutcome& outcome) {
  return {{"method", title(method)},
          {"frame_features", outcome.frame_features},
          {"reference_features", outcome.reference_features},
          {"detect_ms", json_number(outcome.detect_ms)},
          {"describe_ms", json_number(outcome.describe_ms)},
          {"match_ms", json_number(outcome.match_ms)},
          {"reference_ms", json_number(outcome.reference_ms)},
          {"matches", outcome.matches},
          {"matches_agreeing", outcome.matches_agreeing},
          {"best", outcome.best},
          {"best_agreeing", outcome.best_agreeing},
          {"candidates", outcome.candidates},
          {"inliers", outcome.inliers},
          {"scale", json_number(outcome.scale)},
          {"error_m", json_number(outcome.error_m)},
          {"accepted", outcome.accepted},
          {"correct", outcome.correct}};
}

std::vector<std::filesystem::path> output_names(const std::filesystem::path& output,
                                                const std::vector<DescriptorMethod>& pictures) {
  const std::string extension = output.extension().string();
  if (extension == ".csv" || extension == ".json") return {output};
  if (extension != ".md") {
    throw UsageError("output = \"" + output.string() +
                     "\": allowed are NAME.md (with NAME.csv, NAME.json and pictures), NAME.csv and NAME.json");
  }
  std::filesystem::path stem = output;
  stem.replace_extension();
  std::vector<std::filesystem::path> names{output, stem.string() + ".csv", stem.string() + ".json"};
  for (const DescriptorMethod method : pictures) names.emplace_back(stem.string() + "_" + title(method) + ".png");
  return names;
}

}  // namespace

std::string comparison_csv(const Comparison& comparison) {
  std::string text = "method";
  for (const SummaryColumn& column : summary_columns()) text += "," + column.name;
  text += "\n";
  for (const MethodSummary& summary : summarise(comparison)) {
    text += title(summary.method);
    for (const SummaryColumn& column : summary_columns()) {
      const double value = column.get(summary);
      text += "," + (std::isnan(value) ? std::string() : format_number(value));
    }
    text += "\n";
  }
  return text;
}

Json comparison_json(const Comparison& comparison, const ComparisonSource& source) {
  CompareOptions options = source.options;
  Json json;
  json["format"] = "pilotage-comparison";
  json["format_version"] = 1;
  json["software_version"] = source.software_version;
  json["reference"] = source.reference;
  json["frames_file"] = source.frames;
  json["gsd_m"] = json_number(comparison.gsd_m);
  json["seed"] = source.seed;
  json["options"] = options_to_json(list_options(options));
  json["methods"] = Json::array();
  for (const MethodSummary& summary : summarise(comparison)) {
    Json method{{"method", title(summary.method)}};
    for (const SummaryColumn& column : summary_columns()) method[column.name] = json_number(column.get(summary));
    json["methods"].push_back(std::move(method));
  }
  json["frames"] = Json::array();
  for (const FrameComparison& frame : comparison.frames) {
    Json methods = Json::array();
    for (std::size_t i = 0; i < comparison.methods.size(); ++i) {
      methods.push_back(outcome_json(comparison.methods[i], frame.methods[i]));
    }
    json["frames"].push_back({{"file", frame.file},
                              {"shows_reference", frame.shows_reference},
                              {"problem", frame.problem.empty() ? Json() : Json(frame.problem)},
                              {"methods", std::move(methods)}});
  }
  json["warnings"] = comparison.warnings;
  return json;
}

std::vector<std::filesystem::path> write_comparison(const std::filesystem::path& output, const Comparison& comparison,
                                                    const ComparisonSource& source, bool overwrite) {
  std::vector<DescriptorMethod> pictured;
  for (const MatchPicture& picture : comparison.pictures) pictured.push_back(picture.method);
  const std::vector<std::filesystem::path> names = output_names(output, pictured);
  std::vector<std::string> picture_names;
  for (std::size_t i = 3; i < names.size(); ++i) picture_names.push_back(names[i].filename().string());

  std::vector<std::unique_ptr<OutputFile>> files;
  for (std::size_t i = 0; i < names.size(); ++i) {
    auto& file = *files.emplace_back(std::make_unique<OutputFile>(names[i], overwrite));
    const std::string extension = names[i].extension().string();
    if (extension == ".md") file.write(comparison_markdown(comparison, source, picture_names));
    if (extension == ".csv") file.write(comparison_csv(comparison));
    if (extension == ".json") file.write(json_text(comparison_json(comparison, source)));
    if (extension == ".png") file.write(png_bytes(comparison.pictures[i - 3].bgr));
  }
  std::vector<const OutputFile*> outputs;
  for (const auto& file : files) outputs.push_back(file.get());
  OutputFile::commit(outputs, {});
  return names;
}

std::vector<std::filesystem::path> comparison_outputs(const std::filesystem::path& output) {
  std::vector<DescriptorMethod> methods;
  for (const EnumName<DescriptorMethod>& name : enum_names(DescriptorMethod{})) methods.push_back(name.value);
  return output_names(output, methods);
}

void check_comparison_output(const std::filesystem::path& output, const CompareOptions& options, bool overwrite) {
  const std::vector<DescriptorMethod> pictured =
      options.picture_frame > 0 ? options.methods : std::vector<DescriptorMethod>{};
  for (const std::filesystem::path& name : output_names(output, pictured)) OutputFile(name, overwrite);
}

}  // namespace pilotage
