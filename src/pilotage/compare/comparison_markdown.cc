#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

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
constexpr PaperRow kPaperBrief{"BRIEF", 0.4925, 9};
constexpr PaperRow kPaperSurf{"SURF", 1.5539, 10};
constexpr PaperRow kPaperSift{"SIFT", 2.4381, 10};

/// A method of this comparison that the paper has, too: BRIEF at any length.
struct PaperMethod {
  PaperRow paper;
  std::string title;
  std::size_t index;  ///< Of FrameComparison::methods.
};

std::optional<PaperRow> row_of_paper(DescriptorMethod method) {
  switch (method) {
    case DescriptorMethod::kBrief128:
    case DescriptorMethod::kBrief512:
      return kPaperBrief;
    case DescriptorMethod::kSurf:
      return kPaperSurf;
    case DescriptorMethod::kSift:
      return kPaperSift;
    default:
      return std::nullopt;
  }
}

std::vector<PaperMethod> methods_of_paper(const Comparison& comparison) {
  std::vector<PaperMethod> methods;
  for (std::size_t i = 0; i < comparison.methods.size(); ++i) {
    const auto row = row_of_paper(comparison.methods[i]);
    if (row) methods.push_back({*row, std::string(descriptor_method_title(comparison.methods[i])), i});
  }
  return methods;
}

/// Of the frames that `counts` takes: those in which `first` has the smaller value, of those in which the two differ.
/// By frames, because the features of one frame share its ground.
template <class Counts, class Value>
Share frames_as_paper(const Comparison& comparison, const PaperMethod& first, const PaperMethod& second, Counts counts,
                      Value value) {
  Share share;
  for (const FrameComparison& frame : comparison.frames) {
    if (!counts(frame)) continue;
    const double one = value(frame.methods[first.index]);
    const double other = value(frame.methods[second.index]);
    if (one == other) continue;
    ++share.of;
    share.count += one < other ? 1 : 0;
  }
  return share;
}

/// Whether the frames say the opposite of the paper: a pair of methods is told apart where the share's interval leaves
/// out one half.
bool is_reversed(const Share& share) {
  return share.interval().high < 0.5;
}

// "13 of 13 frames: as the paper".
std::string as_paper_text(const Share& share) {
  if (share.of == 0) return "no frame in which they differ";
  const char* const words = share.interval().low > 0.5 ? "as the paper"
                            : is_reversed(share)       ? "the other way round"
                                                       : "not told apart";
  return std::to_string(share.count) + " of " + std::to_string(share.of) + " frames: " + words;
}

bool was_matched(const FrameComparison& frame) {
  return frame.problem.empty();
}

bool shows_truth(const FrameComparison& frame) {
  return frame.shows_reference;
}

double with_reference_ms(const MethodOutcome& outcome) {
  return outcome.total_ms() + outcome.reference_ms;
}

double frame_alone_ms(const MethodOutcome& outcome) {
  return outcome.total_ms();
}

double not_right(const MethodOutcome& outcome) {
  return kBestMatches - outcome.best_agreeing;
}

/// Both of a pair, the paper's better one first.
using PaperPair = std::pair<PaperMethod, PaperMethod>;

template <class Better>
std::vector<PaperPair> paper_pairs(const std::vector<PaperMethod>& methods, Better better) {
  std::vector<PaperPair> pairs;
  for (const PaperMethod& first : methods) {
    for (const PaperMethod& second : methods) {
      if (better(first.paper, second.paper)) pairs.emplace_back(first, second);
    }
  }
  return pairs;
}

// What makes `second` quicker than `first` on a frame, as far as this comparison's own numbers say.
std::string parts_of_times(const MethodSummary& first, const MethodSummary& second) {
  const auto parts = [](const MethodSummary& s) {
    return std::string(descriptor_method_title(s.method)) + " " + format_fixed(s.frame_features, 0) + " features, " +
           ms(s.detect.median_ms + s.describe.median_ms) + " ms to find and describe, " + ms(s.match.median_ms) +
           " ms to match";
  };
  return parts(second) + "; " + parts(first);
}

std::string beside_paper_times(const Comparison& comparison, const std::vector<MethodSummary>& summaries,
                               const std::vector<PaperPair>& pairs) {
  std::string text = row({"quicker in the paper", "both images", "the frame alone, a reference held ready"});
  text += "|---|---|---|\n";
  std::string reasons;
  for (const auto& [first, second] : pairs) {
    const Share both = frames_as_paper(comparison, first, second, was_matched, with_reference_ms);
    const Share alone = frames_as_paper(comparison, first, second, was_matched, frame_alone_ms);
    text += row({first.title + " (" + format_fixed(first.paper.time_s, 2) + " s) than " + second.title + " (" +
                     format_fixed(second.paper.time_s, 2) + " s)",
                 as_paper_text(both), as_paper_text(alone)});
    if (is_reversed(alone)) {
      reasons += "- " + parts_of_times(summaries[first.index], summaries[second.index]) + ".\n";
    }
  }
  if (reasons.empty()) return text;
  return text +
         "\nThe other way round on the frame alone (brute force compares each feature with each of the "
         "reference's, so that few are matched quickly); medians:\n\n" +
         reasons;
}

std::string beside_paper_best(const Comparison& comparison, const std::vector<PaperPair>& pairs, bool raw) {
  std::string text = "\n" + row({"more right of the best ten in the paper", "here"}) + "|---|---|\n";
  bool other_way = false;
  for (const auto& [first, second] : pairs) {
    const Share share = frames_as_paper(comparison, first, second, shows_truth, not_right);
    text += row({first.title + " (" + std::to_string(first.paper.best_right) + ") than " + second.title + " (" +
                     std::to_string(second.paper.best_right) + ")",
                 as_paper_text(share)});
    other_way = other_way || is_reversed(share);
  }
  text += "\nThe paper's ten and nine right matches of one pair of images are not told apart either.\n";
  if (other_way && !raw) {
    text +=
        "Frames lie north up here, so that descriptors that turn with the ground have nothing to gain from it; with "
        "`--raw` they are as the camera made them.\n";
  }
  return text;
}

// What the paper's Table I says of any two of its methods that are compared, and whether the frames here say the same.
// "" unless two of different names were compared on a frame that shows the reference.
std::string beside_paper(const Comparison& comparison, const std::vector<MethodSummary>& summaries, bool raw) {
  const std::vector<PaperMethod> methods = methods_of_paper(comparison);
  const auto by_time = paper_pairs(methods, [](const PaperRow& a, const PaperRow& b) { return a.time_s < b.time_s; });
  const auto by_best =
      paper_pairs(methods, [](const PaperRow& a, const PaperRow& b) { return a.best_right > b.best_right; });
  if (by_time.empty() || std::none_of(comparison.frames.begin(), comparison.frames.end(), shows_truth)) return "";
  std::string text =
      "\n## Beside the paper's Table I\n\nAnother experiment: its images, machine, lengths and numbers of "
      "features are not known. Only which of two is better can be held against each other: frame by frame, "
      "of those in which the two differ, and told apart where the 95 % interval of that share leaves out "
      "one half.\n\n";
  text += beside_paper_times(comparison, summaries, by_time);
  return text + (by_best.empty() ? "" : beside_paper_best(comparison, by_best, raw));
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
  text += beside_paper(comparison, summaries, options.raw) + "\n";
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
