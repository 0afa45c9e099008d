#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "pilotage/base/statistics.h"
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

/// A row of the source paper's Table I: the time for one pair of images, and the right ones of the best ten.
struct PaperRow {
  std::string_view name;
  double time_s;
  int best_right;
};
constexpr std::array<PaperRow, 3> kPaperTable{{{"BRIEF", 0.4925, 9}, {"SURF", 1.5539, 10}, {"SIFT", 2.4381, 10}}};

/// A method of this comparison that the paper has, too: at any length of descriptor.
struct PaperMethod {
  PaperRow paper;
  MethodSummary here;
  std::size_t index;  ///< Of FrameComparison::methods.

  std::string title() const { return std::string(descriptor_method_title(here.method)); }
  double feature_us() const { return 1000 * (here.detect.median_ms + here.describe.median_ms) / here.frame_features; }
};

std::vector<PaperMethod> methods_of_paper(const std::vector<MethodSummary>& summaries) {
  std::vector<PaperMethod> methods;
  for (std::size_t i = 0; i < summaries.size(); ++i) {
    const std::string_view title = descriptor_method_title(summaries[i].method);
    const auto* const row = std::find_if(kPaperTable.begin(), kPaperTable.end(),
                                         [&](const PaperRow& paper) { return title.starts_with(paper.name); });
    if (row != kPaperTable.end() && summaries[i].frame_features > 0) methods.push_back({*row, summaries[i], i});
  }
  return methods;
}

// Smallest first; of equal ones the first stays first.
template <class Value>
std::vector<PaperMethod> ordered(std::vector<PaperMethod> methods, Value value) {
  std::stable_sort(methods.begin(), methods.end(),
                   [&](const PaperMethod& a, const PaperMethod& b) { return value(a) < value(b); });
  return methods;
}

std::string titles(const std::vector<PaperMethod>& methods) {
  std::vector<std::string> names;
  for (const PaperMethod& method : methods) names.push_back(method.title());
  return join(names, ", ");
}

/// Pairs of which the first is smaller here, by `value`, and larger in the paper, by `paper_value`.
template <class Value, class PaperValue>
std::vector<std::pair<PaperMethod, PaperMethod>> reversed(const std::vector<PaperMethod>& order, Value value,
                                                          PaperValue paper_value) {
  std::vector<std::pair<PaperMethod, PaperMethod>> pairs;
  for (std::size_t first = 0; first < order.size(); ++first) {
    for (std::size_t later = first + 1; later < order.size(); ++later) {
      if (value(order[first]) < value(order[later]) &&
          paper_value(order[first].paper) > paper_value(order[later].paper)) {
        pairs.emplace_back(order[first], order[later]);
      }
    }
  }
  return pairs;
}

std::string beside_paper_times(const std::vector<PaperMethod>& methods, const CompareOptions& options) {
  const auto paper_time = [](const PaperRow& row) { return row.time_s; };
  const auto time = [](const PaperMethod& method) { return method.here.total.median_ms; };
  const auto by_time = ordered(methods, time);
  std::string text = "- **Time**, quickest first. The paper: BRIEF, SURF, SIFT. Here: " + titles(by_time);
  if (reversed(by_time, time, paper_time).empty()) return text + ": the paper's order.\n";
  const auto feature_time = [](const PaperMethod& method) { return method.feature_us(); };
  const auto by_feature = ordered(methods, feature_time);
  const auto by_number = ordered(methods, [](const PaperMethod& method) { return method.here.frame_features; });
  const auto number = [](const PaperMethod& method) { return format_fixed(method.here.frame_features, 0); };
  text += ": not the paper's order. By the time for one feature of a frame, found and described: " + titles(by_feature);
  text += reversed(by_feature, feature_time, paper_time).empty() ? ", which is the paper's order"
                                                                 : ", which is not the paper's either";
  return text + ". " + by_number.front().title() + " finds the fewest features, " + number(by_number.front()) +
         " of at most " + std::to_string(options.max_features) + ", " + by_number.back().title() + " the most, " +
         number(by_number.back()) +
         "; brute force compares each with each of the reference's, so that a method that finds few is quick whatever "
         "one of them costs.\n";
}

/// "BRIEF-512 before SIFT: more right in 14 of the 16 frames where they differ (95 %: 61.7 … 98.4 %)", or that chance
/// explains it. By frames, because the matches of one frame share its ground.
std::string better_in_frames(const Comparison& comparison, const PaperMethod& first, const PaperMethod& second) {
  Share better;
  for (const FrameComparison& frame : comparison.frames) {
    const int difference = frame.methods[first.index].best_agreeing - frame.methods[second.index].best_agreeing;
    if (!frame.shows_reference || difference == 0) continue;
    ++better.of;
    better.count += difference > 0 ? 1 : 0;
  }
  std::string text = first.title() + " before " + second.title() + ": more right in " + std::to_string(better.count) +
                     " of the " + std::to_string(better.of) + " frame(s) where they differ (" +
                     percent_with_interval(better) + ")";
  return text + (better.interval().low > 0.5 ? "" : ", which chance explains, too");
}

std::string beside_paper_best(const Comparison& comparison, const std::vector<PaperMethod>& methods,
                              const CompareOptions& options) {
  const auto wrong = [](const PaperMethod& method) { return 1 - method.here.best.value(); };
  const auto by_best = ordered(methods, wrong);
  const auto other_way = reversed(by_best, wrong, [](const PaperRow& row) { return -row.best_right; });
  std::string text =
      "- **Best 10**, most right first. The paper: SURF and SIFT with 10 of 10, BRIEF with 9 of 10: one "
      "match of one pair, which chance explains (see the intervals). Here: " +
      titles(by_best);
  if (other_way.empty()) return text + ": nothing the other way round.\n";
  std::vector<std::string> pairs;
  for (const auto& [first, second] : other_way) pairs.push_back(better_in_frames(comparison, first, second));
  text += ". The other way round stand " + join(pairs, "; ") + ".";
  if (options.raw)
    return text + " The frames are as the camera made them; SURF and SIFT turn with the ground, BRIEF does not.\n";
  return text +
         " The frames lie north up here: BRIEF, which does not turn, loses nothing by it, while SURF and SIFT take "
         "the direction that is known for unknown. `--raw` asks the paper's question.\n";
}

// What the paper's Table I has of the methods compared, both orders, and what of this comparison's own counts explains
// the difference. "" unless two of its methods were compared on a frame that shows the reference.
std::string beside_paper(const Comparison& comparison, const std::vector<MethodSummary>& summaries,
                         const CompareOptions& options) {
  const std::vector<PaperMethod> methods = methods_of_paper(summaries);
  if (methods.size() < 2 || methods.front().here.best.of == 0) return "";
  std::string text =
      "\n## Beside the paper's Table I\n\nAnother experiment: its images, machine, lengths and numbers of "
      "features are not known. Only orders can be held against each other.\n\n";
  text += row({"method", "paper: time, ms", "together, ms", "a feature, µs", "features", "paper: best 10", "best 10"});
  text += "|---|---:|---:|---:|---:|---:|---:|\n";
  for (const PaperMethod& method : methods) {
    text += row({method.title(), ms(1000 * method.paper.time_s), ms(method.here.total.median_ms),
                 ms(method.feature_us()), format_fixed(method.here.frame_features, 0),
                 percent_with_interval({method.paper.best_right, kBestMatches}), percent(method.here.best)});
  }
  return text + "\n" + beside_paper_times(methods, options) + beside_paper_best(comparison, methods, options);
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
  const std::vector<MethodSummary> summaries = summarise(comparison);
  text += tables(summaries) + "\n" + meanings(options);
  text += beside_paper(comparison, summaries, options) + "\n";
  text += "Reference: " + join(source.reference, ", ") + ". Frames: " + source.frames + ". Seed " +
          std::to_string(source.seed) + ". " + source.software_version + ".\n";
  if (pictures.empty()) return text;
  text += "\n## The ten best matches\n\n";
  text += "Frame " + std::to_string(options.picture_frame) +
          " on the left, the reference on the right. Solid blue: "
          "agrees with the truth; dashed orange: does not. Yellow dots: all features that were found.\n";
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string name(descriptor_method_title(comparison.pictures[i].method));
    text += "\n![The ten best matches of " + name + "](<" + pictures[i] + ">)\n";
  }
  return text;
}

}  // namespace pilotage
