#include "pilotage/compare/comparison_summary.h"

#include <numeric>

namespace pilotage {
namespace {

double median(const std::vector<double>& values) {
  return quantile(values, 0.5);
}

void add_share(std::vector<SummaryColumn>& columns, const std::string& name, const std::string& help,
               Share MethodSummary::*share, bool with_interval) {
  columns.push_back({name, help, [share](const MethodSummary& s) { return (s.*share).value(); }});
  if (!with_interval) return;
  const auto interval = [share](const MethodSummary& s) { return (s.*share).interval(); };
  columns.push_back({name + "_low", "Lower end of its 95 % confidence interval.",
                     [interval](const MethodSummary& s) { return interval(s).low; }});
  columns.push_back({name + "_high", "Upper end of its 95 % confidence interval.",
                     [interval](const MethodSummary& s) { return interval(s).high; }});
}

void add_times(std::vector<SummaryColumn>& columns, const std::string& name, const std::string& help,
               Times MethodSummary::*times) {
  columns.push_back({name + "_median_ms", help + " Median over the frames.",
                     [times](const MethodSummary& s) { return (s.*times).median_ms; }});
  columns.push_back({name + "_sum_ms", help + " Sum over the frames.",
                     [times](const MethodSummary& s) { return (s.*times).sum_ms; }});
}

std::vector<SummaryColumn> make_columns() {
  std::vector<SummaryColumn> columns;
  add_times(columns, "detect", "Finding the frame's features.", &MethodSummary::detect);
  add_times(columns, "describe", "Describing them.", &MethodSummary::describe);
  add_times(columns, "match", "Comparing them with those of the reference, by brute force.", &MethodSummary::match);
  add_times(columns, "total", "The three together.", &MethodSummary::total);
  add_times(columns, "reference", "Finding and describing the reference's features.", &MethodSummary::reference);
  columns.push_back(
      {"frame_features", "Features of a frame, median.", [](const MethodSummary& s) { return s.frame_features; }});
  columns.push_back({"reference_features", "Features of the reference, median.",
                     [](const MethodSummary& s) { return s.reference_features; }});
  add_share(columns, "best_10_accuracy", "Share of the ten best matches that agree with the truth.",
            &MethodSummary::best, false);
  add_share(columns, "matches_agreeing", "Share of all matches that agree with the truth.", &MethodSummary::matches,
            false);
  add_share(columns, "inlier_share", "Share of the matches after the ratio test that agree with the transform.",
            &MethodSummary::inliers, false);
  add_share(columns, "correct_fix_rate", "Correct fixes, of the frames that show the reference.",
            &MethodSummary::correct, true);
  add_share(columns, "false_fix_rate", "Accepted fixes that are not correct, of all frames.", &MethodSummary::wrong,
            true);
  add_share(columns, "false_of_accepted", "The same, of the accepted fixes.", &MethodSummary::wrong_of_accepted, true);
  return columns;
}

MethodSummary summarise_method(const Comparison& comparison, std::size_t index) {
  std::vector<double> detect;
  std::vector<double> describe;
  std::vector<double> match;
  std::vector<double> total;
  std::vector<double> reference;
  std::vector<double> frame_features;
  std::vector<double> reference_features;
  MethodSummary summary;
  summary.method = comparison.methods[index];
  for (const FrameComparison& frame : comparison.frames) {
    const MethodOutcome& outcome = frame.methods[index];
    const bool wrong = outcome.accepted && !outcome.correct;
    ++summary.wrong.of;
    summary.wrong.count += wrong ? 1 : 0;
    summary.wrong_of_accepted.of += outcome.accepted ? 1 : 0;
    summary.wrong_of_accepted.count += wrong ? 1 : 0;
    if (frame.shows_reference) {
      ++summary.correct.of;
      summary.correct.count += outcome.correct ? 1 : 0;
      summary.best.of += kBestMatches;
      summary.best.count += outcome.best_agreeing;
      summary.matches.of += outcome.matches;
      summary.matches.count += outcome.matches_agreeing;
      summary.inliers.of += outcome.candidates;
      summary.inliers.count += outcome.inliers;
    }
    if (!frame.problem.empty()) continue;
    detect.push_back(outcome.detect_ms);
    describe.push_back(outcome.describe_ms);
    match.push_back(outcome.match_ms);
    total.push_back(outcome.total_ms());
    reference.push_back(outcome.reference_ms);
    frame_features.push_back(outcome.frame_features);
    reference_features.push_back(outcome.reference_features);
  }
  const auto times = [](const std::vector<double>& ms) {
    return Times{median(ms), std::accumulate(ms.begin(), ms.end(), 0.0)};
  };
  summary.detect = times(detect);
  summary.describe = times(describe);
  summary.match = times(match);
  summary.total = times(total);
  summary.reference = times(reference);
  summary.frame_features = median(frame_features);
  summary.reference_features = median(reference_features);
  return summary;
}

}  // namespace

std::vector<MethodSummary> summarise(const Comparison& comparison) {
  std::vector<MethodSummary> summaries;
  for (std::size_t i = 0; i < comparison.methods.size(); ++i) summaries.push_back(summarise_method(comparison, i));
  return summaries;
}

const std::vector<SummaryColumn>& summary_columns() {
  static const std::vector<SummaryColumn> columns = make_columns();
  return columns;
}

}  // namespace pilotage
