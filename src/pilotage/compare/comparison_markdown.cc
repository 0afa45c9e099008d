#include <algorithm>
#include <cmath>

#include "pilotage/base/text.h"
#include "pilotage/compare/comparison_files.h"
#include "pilotage/compare/comparison_summary.h"

namespace pilotage {
namespace {

std::string percent(double share) {
  return std::isnan(share) ? "–" : format_fixed(100 * share, 1) + " %";
}

std::string percent(const Share& share) {
  return percent(share.value());
}

// "95.0 % (91.2 … 97.5)".
std::string percent_with_interval(const Share& share) {
  if (share.of == 0) return "–";
  const Interval interval = share.interval();
  return percent(share) + " (" + format_fixed(100 * interval.low, 1) + " … " + format_fixed(100 * interval.high, 1) +
         ")";
}

std::string ms(double value) {
  return std::isnan(value) ? "–" : format_fixed(value, 1);
}

std::string row(const std::vector<std::string>& cells) {
  return "| " + join(cells, " | ") + " |\n";
}

std::string frames_sentence(const Comparison& comparison) {
  const auto all = comparison.frames.size();
  const auto showing = std::count_if(comparison.frames.begin(), comparison.frames.end(),
                                     [](const FrameComparison& frame) { return frame.shows_reference; });
  const auto problems = std::count_if(comparison.frames.begin(), comparison.frames.end(),
                                      [](const FrameComparison& frame) { return !frame.problem.empty(); });
  return std::to_string(all) + " frame(s): " + std::to_string(showing) +
         " show the reference around their prior, the others other ground (" + std::to_string(problems) +
         " could not be matched at all).";
}

std::string tables(const std::vector<MethodSummary>& summaries) {
  std::string text = row({"method", "detect, ms", "describe, ms", "match, ms", "together, ms", "reference, ms",
                          "features", "of reference", "best 10", "matches", "inliers"});
  text += "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const MethodSummary& s : summaries) {
    text += row({std::string(descriptor_method_title(s.method)), ms(s.detect.median_ms), ms(s.describe.median_ms),
                 ms(s.match.median_ms), ms(s.total.median_ms), ms(s.reference.median_ms),
                 std::isnan(s.frame_features) ? "–" : format_fixed(s.frame_features, 0),
                 std::isnan(s.reference_features) ? "–" : format_fixed(s.reference_features, 0), percent(s.best),
                 percent(s.matches), percent(s.inliers)});
  }
  text += "\n" + row({"method", "correct fix", "false fix", "false among accepted"});
  text += "|---|---:|---:|---:|\n";
  for (const MethodSummary& s : summaries) {
    text += row({std::string(descriptor_method_title(s.method)), percent_with_interval(s.correct),
                 percent_with_interval(s.wrong), percent_with_interval(s.wrong_of_accepted)});
  }
  return text;
}

std::string meanings(const CompareOptions& options) {
  return "- **Times**: median over the frames, one thread. Reference: finding and describing its features, which a map "
         "holds ready.\n"
         "- **best 10**: share of the ten matches of smallest distance that lie within " +
         format_number(options.tolerance_m) +
         " m of the truth, over the frames that show the reference; a missing match counts as wrong.\n"
         "- **matches**: the same share of all matches, one for each feature of a frame.\n"
         "- **inliers**: share of the matches after the ratio test (" +
         format_number(options.ratio) + ") that agree with the transform.\n" +
         "- **correct fix**: of the frames that show the reference, those with an accepted fix within " +
         format_number(options.correct_within_m) +
         " m. **false fix**: accepted fixes that are not correct, of all frames; **among accepted**, of the accepted "
         "ones. In brackets: 95 % confidence (Clopper–Pearson).\n"
         "- A fix is a rotation, scale and shift by RANSAC (" +
         format_number(options.ransac_threshold_px) + " px); it is accepted with at least " +
         std::to_string(options.min_inliers) + " inliers, a scale within " +
         format_number(100 * options.max_scale_error) +
         " % of that of height and camera, and a position within the prior's window of ± " +
         format_number(options.search_sigmas) + " σ.\n";
}

}  // namespace

std::string comparison_markdown(const Comparison& comparison, const ComparisonSource& source,
                                const std::vector<std::string>& pictures) {
  const CompareOptions& options = source.options;
  std::string text = "# Features compared\n\n";
  text += frames_sentence(comparison) + " ";
  text += options.raw ? "Frames as the camera made them. "
                      : "Frames laid on the ground, north up, with the stated attitude and height. ";
  text += "Reference at " + format_number(comparison.gsd_m) + " m/px. At most " + std::to_string(options.max_features) +
          " features in a frame, as many on the same area of the reference. Brute-force matching.\n\n";
  text += tables(summarise(comparison)) + "\n" + meanings(options) + "\n";
  text += "Reference: " + join(source.reference, ", ") + ". Frames: " + source.frames + ". Seed " +
          std::to_string(source.seed) + ". " + source.software_version + ".\n";
  if (pictures.empty()) return text;
  text += "\n## The ten best matches\n\n";
  text += "Frame " + std::to_string(options.picture_frame) +
          " on the left, the reference on the right. Solid blue: "
          "agrees with the truth; dashed orange: does not.\n";
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string name(descriptor_method_title(comparison.pictures[i].method));
    text += "\n![The ten best matches of " + name + "](<" + pictures[i] + ">)\n";
  }
  return text;
}

}  // namespace pilotage
