#include "pilotage/compare/compare.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/utility.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/compare/compared_pair.h"
#include "pilotage/compare/match_features.h"
#include "pilotage/compare/match_picture.h"
#include "pilotage/compare/stopwatch.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

constexpr double kWorkingGsdM = 0.6;
// cv::BFMatcher takes 2^18 descriptors at most.
constexpr int kMaxReferenceFeatures = 200000;

/// Holds OpenCV to one thread.
class OneThread {
 public:
  OneThread() : before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  ~OneThread() { cv::setNumThreads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

void check(const CompareOptions& options, std::size_t frames) {
  check_options(options);
  if (options.methods.empty()) throw UsageError("methods: give at least one");
  for (std::size_t i = 0; i < options.methods.size(); ++i) {
    const auto later = options.methods.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    if (std::find(later, options.methods.end(), options.methods[i]) != options.methods.end()) {
      throw UsageError("methods: duplicate " + std::string(descriptor_method_title(options.methods[i])));
    }
  }
  if (static_cast<std::size_t>(options.picture_frame) > frames) {
    throw UsageError("picture_frame = " + std::to_string(options.picture_frame) + ": there are " +
                     std::to_string(frames) + " frame(s)");
  }
}

double reference_gsd_m(const std::vector<std::string>& reference, const CompareOptions& options) {
  double own = 0;
  for (const std::string& dataset : reference) {
    const ImageryInfo info = inspect_imagery(dataset, options.imagery);
    own = std::max({own, info.gsd_x_m, info.gsd_y_m});
  }
  if (options.gsd_m) return *options.gsd_m;
  return options.raw ? own : std::max(own, kWorkingGsdM);
}

// As many as the frame's for the same ground.
int reference_features(const ComparedPair& pair, int max_features) {
  const double area_m2 = cv::countNonZero(pair.reference_allowed) * pair.gsd_m * pair.gsd_m;
  const double wanted = pair.frame_area_m2 > 0 ? max_features * area_m2 / pair.frame_area_m2 : 0;
  return static_cast<int>(std::clamp(std::round(wanted), 1.0, static_cast<double>(kMaxReferenceFeatures)));
}

bool agrees(const ComparedPair& pair, const DescribedImage& frame, const DescribedImage& reference,
            const FeatureMatch& match, double tolerance_m) {
  const auto truth = pair.true_ground(frame.points_px[static_cast<std::size_t>(match.frame)]);
  if (!truth) return false;
  const Eigen::Vector2d found =
      pair.ground_from_reference(reference.points_px[static_cast<std::size_t>(match.reference)]);
  return (found - *truth).norm() <= tolerance_m;
}

void judge_fix(const ComparedPair& pair, const SimilarityFit& fit, const CompareOptions& options,
               MethodOutcome& outcome) {
  outcome.candidates = fit.candidates;
  outcome.inliers = fit.inliers;
  if (fit.inliers == 0) return;
  const Eigen::Vector2d position = pair.ground_from_reference(fit.reference_from_frame_px(pair.anchor_px));
  outcome.scale = fit.scale() / pair.expected_scale;
  outcome.error_m = (position - pair.true_anchor_m).norm();
  const bool in_window = (position - pair.anchor_m).cwiseAbs().maxCoeff() <= pair.search_m;
  outcome.accepted =
      fit.inliers >= options.min_inliers && std::abs(outcome.scale - 1) <= options.max_scale_error && in_window;
  outcome.correct = outcome.accepted && pair.shows_reference && outcome.error_m <= options.correct_within_m;
}

struct MethodRun {
  MethodOutcome outcome;
  std::vector<JudgedMatch> best;
  std::vector<Eigen::Vector2d> frame_px;  ///< The features.
  std::vector<Eigen::Vector2d> reference_px;
};

MethodRun run_method(DescriptorMethod method, const ComparedPair& pair, const CompareOptions& options,
                     std::uint64_t seed) {
  MethodRun run;
  MethodOutcome& outcome = run.outcome;
  DescribedImage frame = describe_image(method, pair.frame, pair.frame_allowed, options.max_features);
  outcome.detect_ms = frame.detect_ms;
  outcome.describe_ms = frame.describe_ms;
  DescribedImage reference =
      describe_image(method, pair.reference, pair.reference_allowed, reference_features(pair, options.max_features));
  outcome.reference_ms = reference.detect_ms + reference.describe_ms;
  outcome.frame_features = static_cast<int>(frame.points_px.size());
  outcome.reference_features = static_cast<int>(reference.points_px.size());

  Stopwatch watch;
  const std::vector<FeatureMatch> matches = match_by_brute_force(frame, reference);
  outcome.match_ms = watch.lap_ms();
  outcome.matches = static_cast<int>(matches.size());
  for (const FeatureMatch& match : matches) {
    const bool agreeing = pair.shows_reference && agrees(pair, frame, reference, match, options.tolerance_m);
    outcome.matches_agreeing += agreeing ? 1 : 0;
    if (outcome.best >= kBestMatches) continue;
    ++outcome.best;
    outcome.best_agreeing += agreeing ? 1 : 0;
    run.best.push_back({frame.points_px[static_cast<std::size_t>(match.frame)],
                        reference.points_px[static_cast<std::size_t>(match.reference)], agreeing});
  }
  judge_fix(pair, fit_similarity(frame, reference, matches, {options.ratio, options.ransac_threshold_px}, seed),
            options, outcome);
  run.frame_px = std::move(frame.points_px);
  run.reference_px = std::move(reference.points_px);
  return run;
}

void draw_pictures(const ComparedPair& pair, const std::vector<MethodRun>& runs, double tolerance_m,
                   Comparison& comparison) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const DescriptorMethod method = comparison.methods[i];
    comparison.pictures.push_back(
        {method, draw_matches(descriptor_method_title(method), {pair.frame, runs[i].frame_px},
                              {pair.reference, runs[i].reference_px}, runs[i].best, tolerance_m)});
  }
}

}  // namespace

Comparison compare(const std::vector<std::string>& reference, const std::vector<FrameRecord>& frames,
                   const FrameReader& read_frame, const Camera& camera, const CompareOptions& options,
                   std::uint64_t seed, const Progress& progress) {
  check(options, frames.size());
  const OneThread one_thread;
  Comparison comparison;
  comparison.methods = options.methods;
  comparison.gsd_m = reference_gsd_m(reference, options);
  bool warm = false;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto report = [&] {
      report_progress(progress, "frames", static_cast<std::int64_t>(i), static_cast<std::int64_t>(frames.size()));
    };
    report();
    const cv::Mat pixels = read_frame(frames[i]);
    if (pixels.cols != camera.width_px || pixels.rows != camera.height_px) {
      throw DataError(frames[i].file + ": is " + std::to_string(pixels.cols) + " x " + std::to_string(pixels.rows) +
                      " px, the camera's images are " + std::to_string(camera.width_px) + " x " +
                      std::to_string(camera.height_px) + " px");
    }
    FrameComparison result;
    result.file = frames[i].file;
    const PairOrProblem made = make_compared_pair(reference, frames[i], pixels, camera, comparison.gsd_m, options);
    std::vector<MethodRun> runs(options.methods.size());
    if (const auto* pair = std::get_if<ComparedPair>(&made)) {
      result.shows_reference = pair->shows_reference;
      for (std::size_t m = 0; m < options.methods.size(); ++m) {
        const std::uint64_t frame_seed = derive_seed(seed, i);
        report();  // a frame takes a second or two
        if (!warm) run_method(options.methods[m], *pair, options, frame_seed);
        report();
        runs[m] = run_method(options.methods[m], *pair, options, frame_seed);
      }
      warm = true;
      if (i + 1 == static_cast<std::size_t>(options.picture_frame)) {
        draw_pictures(*pair, runs, options.tolerance_m, comparison);
      }
    } else {
      result.problem = std::get<std::string>(made);
    }
    for (const MethodRun& run : runs) result.methods.push_back(run.outcome);
    comparison.frames.push_back(std::move(result));
  }
  report_progress(progress, "frames", static_cast<std::int64_t>(frames.size()),
                  static_cast<std::int64_t>(frames.size()));
  return comparison;
}

}  // namespace pilotage
