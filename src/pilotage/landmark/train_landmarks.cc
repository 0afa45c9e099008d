#include "pilotage/landmark/train_landmarks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <set>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/degradation/degradation.h"
#include "pilotage/landmark/detections.h"
#include "pilotage/landmark/outline.h"
#include "pilotage/landmark/training_chips.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

/// Side of the window over the length of a landmark: what lies around it tells it, too.
constexpr double kContext = 1.3;
/// What is cut around a landmark to learn from, in lengths; chips are wide enough for it at any heading.
constexpr double kCropLengths = 2.2;
constexpr int kHeadingBins = 8;
/// Outlines at least as round have no heading (an octagon has 0.95, a square 0.79).
constexpr double kRound = 0.9;
/// Outlines whose width is more of their length look alike every quarter turn.
constexpr double kSquareWidth = 0.8;
constexpr int kHardRounds = 2;

/// A label of the class that is to be found on its chip.
struct Sample {
  std::size_t chip = 0;
  OrientedBox box_px;
  Vector2d center_m{0, 0};
  double length_m = 0;
  std::vector<OrientedBox> ignored_px;  ///< Others of its class.
  std::size_t block = 0;
  bool first_of_place = true;  ///< Not one of a landmark that an earlier folder shows on another date.
};

/// What is learnt of one class.
struct ClassSamples {
  std::string name;
  std::vector<Sample> samples;
  std::vector<std::size_t> background;  ///< Chips whose own label is none, or of another class.
  std::vector<std::size_t> background_block;
  int too_small = 0;  ///< Labels shorter than kLeastLength_px: neither learnt nor background.
  std::string first_too_small;
  bool box_alone = false;
  bool round = false;
  double period_deg = 0;
  std::size_t bins = 1;
  double gsd_m = 0;
  FhogWindow window;
  double shortest_m = 0;
  double longest_m = 0;
};

double median_of(std::vector<double> values) {
  return quantile(std::move(values), 0.5);
}

std::vector<std::string> class_names_of(const TrainingChips& chips) {
  std::set<std::string> names;
  for (const TrainingChip& chip : chips.chips) {
    for (const PictureLabel& label : chip.labels) {
      if (!label.ignore) names.insert(label.class_name);
    }
  }
  return {names.begin(), names.end()};
}

/// The ground around an outline on a chip.
Bounds ground_of(const TrainingChips& chips, const TrainingChip& chip, const std::vector<Vector2d>& outline_px) {
  Bounds bounds;
  const Vector2d corner_m(chip.bounds_m.min_x_m, chip.bounds_m.max_y_m);
  for (const Vector2d& point : outline_px) bounds.extend(corner_m + chips.gsd_m * Vector2d(point.x(), -point.y()));
  return bounds;
}

/// Whether a chip shows a landmark of a class, labelled on it or on a chip of another folder, which was cut with labels
/// of other classes.
bool shows_class(const TrainingChips& chips, const TrainingChip& chip, const std::string& name) {
  for (const TrainingChip& other : chips.chips) {
    if (!other.bounds_m.intersects(chip.bounds_m)) continue;
    for (const PictureLabel& label : other.labels) {
      if (label.class_name == name && ground_of(chips, other, label.outline_px).intersects(chip.bounds_m)) return true;
    }
  }
  return false;
}

ClassSamples samples_of(const TrainingChips& chips, const std::string& name) {
  ClassSamples found;
  found.name = name;
  std::vector<double> roundness;
  std::vector<double> widths;
  int boxes_alone = 0;
  for (std::size_t number = 0; number < chips.chips.size(); ++number) {
    const TrainingChip& chip = chips.chips[number];
    if (!shows_class(chips, chip, name)) found.background.push_back(number);
    for (const PictureLabel& label : chip.labels) {
      if (label.ignore || label.class_name != name) continue;
      Sample sample;
      sample.chip = number;
      sample.box_px = oriented_box(label.outline_px);
      sample.length_m = sample.box_px.length * chips.gsd_m;
      sample.center_m = Vector2d(chip.bounds_m.min_x_m, chip.bounds_m.max_y_m) +
                        chips.gsd_m * Vector2d(sample.box_px.center.x(), -sample.box_px.center.y());
      sample.first_of_place = std::none_of(found.samples.begin(), found.samples.end(), [&](const Sample& other) {
        return (other.center_m - sample.center_m).norm() < kSamePlace * sample.length_m;
      });
      for (const PictureLabel& other : chip.labels) {
        if (&other == &label || other.class_name != name) continue;
        sample.ignored_px.push_back(oriented_box(other.outline_px));
      }
      if (sample.box_px.length < kLeastLength_px) {
        if (found.too_small++ == 0) {
          found.first_too_small = label.name + ", " + format_fixed(sample.box_px.length, 1) + " px";
        }
        continue;
      }
      roundness.push_back(circularity(label.outline_px));
      widths.push_back(sample.box_px.width / sample.box_px.length);
      boxes_alone += label.box_alone ? 1 : 0;
      found.samples.push_back(std::move(sample));
    }
  }
  const auto places = std::count_if(found.samples.begin(), found.samples.end(),
                                    [](const Sample& sample) { return sample.first_of_place; });
  if (places < kLeastLabels) {
    throw DataError(name + ": has " + std::to_string(places) + " labelled landmarks of " +
                    format_number(kLeastLength_px) + " px and more; a detector is trained from " +
                    std::to_string(kLeastLabels) + " on");
  }
  found.box_alone = 2 * boxes_alone > static_cast<int>(found.samples.size());
  found.round = !found.box_alone && median_of(roundness) >= kRound;
  found.period_deg = median_of(widths) > kSquareWidth ? 90 : 180;
  return found;
}

void choose_geometry(const TrainOptions& options, ClassSamples& of) {
  std::vector<double> lengths_m;
  for (const Sample& sample : of.samples) lengths_m.push_back(sample.length_m);
  of.shortest_m = quantile(lengths_m, 0);
  of.longest_m = quantile(lengths_m, 1);
  const double window_m = kContext * quantile(lengths_m, 0.2);
  of.window.side_px = options.window_px;
  of.window.cell_px = options.cell_px;
  of.gsd_m = window_m / options.window_px;
  const double levels = std::ceil(std::log(kContext * of.longest_m / window_m) / std::log(kFhogPyramidStep));
  of.window.levels = 1 + std::max(0, static_cast<int>(levels));
  if (options.heading_bins == 1 || (options.heading_bins == 0 && (of.round || of.box_alone))) {
    of.bins = 1;
    of.period_deg = 0;
  } else {
    of.bins = static_cast<std::size_t>(options.heading_bins == 0 ? kHeadingBins : options.heading_bins);
  }
}

/// Strips across the longer side of the labels' ground, with as many labels each.
void cut_blocks(const TrainingChips& chips, std::size_t blocks, ClassSamples& of) {
  Bounds bounds;
  for (const Sample& sample : of.samples) bounds.extend(sample.center_m);
  const int axis = bounds.width_m() >= bounds.height_m() ? 0 : 1;
  std::vector<double> places;
  for (const Sample& sample : of.samples) places.push_back(sample.center_m[axis]);
  std::vector<double> borders;
  for (std::size_t i = 1; i < blocks; ++i) {
    borders.push_back(quantile(places, static_cast<double>(i) / static_cast<double>(blocks)));
  }
  const auto block_at = [&](double place) {
    return static_cast<std::size_t>(std::count_if(borders.begin(), borders.end(), [&](double b) { return place > b; }));
  };
  for (Sample& sample : of.samples) sample.block = block_at(sample.center_m[axis]);
  of.background_block.clear();
  for (const std::size_t chip : of.background) {
    of.background_block.push_back(block_at(chips.chips[chip].bounds_m.center_m()[axis]));
  }
}

cv::Rect square_around(const Vector2d& center, double side) {
  const int whole = std::max(1, static_cast<int>(std::lround(side)));
  return {static_cast<int>(std::lround(center.x() - whole / 2.0)),
          static_cast<int>(std::lround(center.y() - whole / 2.0)), whole, whole};
}

/// A landmark cut out of its chip, turned by `turn_rad` clockwise about its middle, in the detector's pixels; the
/// middle lies `off_px` from that of the crop.
TrainingPicture crop_of(const TrainingChips& chips, const ClassSamples& of, const Sample& sample, double turn_rad,
                        const Vector2d& off_px) {
  const cv::Mat& chip = chips.chips[sample.chip].gray;
  const double scale = chips.gsd_m / of.gsd_m;
  const double window = kContext * sample.box_px.length * scale;
  const int side = static_cast<int>(std::ceil(std::max(
      kCropLengths * sample.box_px.length * scale, static_cast<double>(of.window.side_px + 4 * of.window.cell_px))));
  cv::Mat source = chip;
  double shrink = 1;
  if (scale < 0.75) {  // without it fine detail would be skipped and not averaged
    cv::resize(chip, source, {}, scale, scale, cv::INTER_AREA);
    shrink = scale;
  }
  // Pixels of the crop → pixels of the chip.
  const double step = shrink / scale;
  const double c = std::cos(turn_rad) * step;
  const double s = std::sin(turn_rad) * step;
  const Vector2d middle = sample.box_px.center * shrink - Vector2d(0.5, 0.5);
  const Vector2d at_px = Vector2d(side / 2.0, side / 2.0) + off_px;
  const Vector2d from = at_px - Vector2d(0.5, 0.5);
  const cv::Matx23d inverse(c, s, middle.x() - c * from.x() - s * from.y(), -s, c,
                            middle.y() + s * from.x() - c * from.y());
  TrainingPicture picture;
  cv::warpAffine(source, picture.gray, inverse, {side, side}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  picture.boxes.push_back(square_around(at_px, window));
  for (const OrientedBox& other : sample.ignored_px) {
    const Vector2d d = (other.center - sample.box_px.center) * scale;
    const Vector2d turned(std::cos(turn_rad) * d.x() - std::sin(turn_rad) * d.y(),
                          std::sin(turn_rad) * d.x() + std::cos(turn_rad) * d.y());
    picture.ignored.push_back(square_around(at_px + turned, kContext * other.length * scale));
  }
  return picture;
}

/// As another day and another camera might show it; its place and size stay.
cv::Mat degraded(const cv::Mat& gray, std::uint64_t seed, int copy) {
  DegradationOptions options;
  options.rotation_deg = 0;
  options.scale_percent = 0;
  cv::Mat values;
  gray.convertTo(values, CV_32F);
  const cv::Mat copied = Degrader(gray.cols, 0, options, seed, copy).apply(values);  // 0 … 1 and a little beyond
  cv::Mat bytes;
  double low = 0;
  double high = 0;
  cv::minMaxLoc(gray, &low, &high);
  copied.convertTo(bytes, CV_8U, std::max(high - low, 1.0), low);
  return bytes;
}

/// Clockwise turn that brings a landmark to the heading of a filter. Angles of boxes on chips, whose rows run
/// downwards, grow clockwise from the x axis.
double turn_to(const OrientedBox& box_px, double heading_deg) {
  return (heading_deg - 90) * std::numbers::pi / 180 - box_px.angle_rad;
}

cv::Mat background_of(const TrainingChips& chips, const ClassSamples& of, std::size_t chip) {
  const double scale = chips.gsd_m / of.gsd_m;
  cv::Mat seen;
  cv::resize(chips.chips[chip].gray, seen, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return seen;
}

/// What a filter learns: of all labels, or without the ground of one block.
std::vector<TrainingPicture> pictures_for(const TrainingChips& chips, const ClassSamples& of,
                                          const std::vector<std::size_t>& samples, double heading_deg,
                                          const TrainOptions& options, std::uint64_t seed) {
  std::vector<TrainingPicture> pictures;
  for (const std::size_t number : samples) {
    const Sample& sample = of.samples[number];
    Random random(derive_seed(seed, number));
    for (int copy = 0; copy <= options.copies; ++copy) {
      double turn_rad = 0;
      if (of.bins > 1) {
        const double jitter_deg =
            copy == 0 ? 0 : random.uniform(-0.5, 0.5) * of.period_deg / static_cast<double>(of.bins);
        turn_rad = turn_to(sample.box_px, heading_deg + jitter_deg);
      } else if (of.round && copy > 0) {
        turn_rad = random.uniform(0, 2 * std::numbers::pi);
      }
      // Anywhere in a cell: landmarks that all lay alike on the cells would be found beside their place.
      const double cell_px = of.window.cell_px;
      const Vector2d off_px(random.uniform(-0.5, 0.5) * cell_px, random.uniform(-0.5, 0.5) * cell_px);
      TrainingPicture picture = crop_of(chips, of, sample, turn_rad, off_px);
      if (copy > 0) picture.gray = degraded(picture.gray, derive_seed(seed, 1'000'000 + number), copy - 1);
      pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

LandmarkDetector detector_of(const ClassSamples& of, std::vector<std::vector<float>> filters) {
  LandmarkDetector detector;
  detector.class_name = of.name;
  detector.gsd_m = of.gsd_m;
  detector.window = of.window;
  detector.context = kContext;
  detector.period_deg = of.period_deg;
  detector.filters = std::move(filters);
  detector.shortest_m = of.shortest_m;
  detector.longest_m = of.longest_m;
  return detector;
}

std::vector<float> train_filter(const TrainingChips& chips, const ClassSamples& of,
                                const std::vector<std::size_t>& samples, const std::vector<std::size_t>& background,
                                double heading_deg, const TrainOptions& options, std::uint64_t seed,
                                int& unobtainable) {
  std::vector<TrainingPicture> pictures = pictures_for(chips, of, samples, heading_deg, options, seed);
  TrainingOptions training;
  training.c = options.c;
  TrainedFilter filter = train_fhog(pictures, of.window, training);
  std::vector<bool> learnt(background.size(), false);
  for (int round = 0; round < kHardRounds; ++round) {
    bool any = false;
    for (std::size_t i = 0; i < background.size(); ++i) {
      if (learnt[i]) continue;
      const cv::Mat& gray = chips.chips[background[i]].gray;
      if (detect_landmarks(detector_of(of, {filter.weights}), gray, chips.gsd_m, kLeastScore / 2).empty()) continue;
      learnt[i] = true;
      any = true;
      pictures.push_back({background_of(chips, of, background[i]), {}, {}});
    }
    if (!any) break;
    filter = train_fhog(pictures, of.window, training);
  }
  unobtainable = filter.unobtainable;
  return filter.weights;
}

/// Hits on the chip of a label: right is the best one at its place; what lies on others of its class counts neither
/// way.
void judge_chip(const TrainingChips& chips, const LandmarkDetector& detector, const Sample& sample,
                std::vector<JudgedHit>& judged) {
  bool found = false;
  for (const LandmarkHit& hit : detect_landmarks(detector, chips.chips[sample.chip].gray, chips.gsd_m, kLeastScore)) {
    const bool here = (hit.center_px - sample.box_px.center).norm() < kSamePlace * sample.box_px.length;
    const bool ignored = std::any_of(sample.ignored_px.begin(), sample.ignored_px.end(), [&](const OrientedBox& other) {
      return (hit.center_px - other.center).norm() < kSamePlace * std::max(other.length, sample.box_px.length);
    });
    if (!here && ignored) continue;
    judged.push_back({hit.score, here && !found, sample.block});
    found = found || here;
  }
}

/// How far hits lie beside landmarks that the detector learnt, medians in sides of their windows: cells are counted
/// from the corner of a picture, and where in its cells a filter has its middle is a matter of rounding.
Vector2d usual_offset(const TrainingChips& chips, const ClassSamples& of, const LandmarkDetector& detector) {
  std::vector<double> x;
  std::vector<double> y;
  for (const Sample& sample : of.samples) {
    for (const LandmarkHit& hit : detect_landmarks(detector, chips.chips[sample.chip].gray, chips.gsd_m, 0)) {
      const Vector2d off = (hit.center_px - sample.box_px.center) / (detector.context * hit.length_px);
      if (off.norm() > kSamePlace / 2) continue;
      x.push_back(off.x());
      y.push_back(off.y());
      break;
    }
  }
  return x.empty() ? Vector2d(0, 0) : Vector2d(median_of(x), median_of(y));
}

/// Whether two chips share ground.
bool share_ground(const TrainingChip& a, const TrainingChip& b) {
  return a.bounds_m.intersects(b.bounds_m);
}

/// Labels and background chips that are learnt when a block is left out: those of other blocks whose chips share no
/// ground with its chips.
struct LeftIn {
  std::vector<std::size_t> samples;
  std::vector<std::size_t> background;
};

LeftIn without_block(const TrainingChips& chips, const ClassSamples& of, std::size_t block) {
  std::vector<std::size_t> out;
  for (const Sample& sample : of.samples) {
    if (sample.block == block) out.push_back(sample.chip);
  }
  for (std::size_t i = 0; i < of.background.size(); ++i) {
    if (of.background_block[i] == block) out.push_back(of.background[i]);
  }
  const auto apart = [&](std::size_t chip) {
    return std::none_of(out.begin(), out.end(),
                        [&](std::size_t other) { return share_ground(chips.chips[chip], chips.chips[other]); });
  };
  LeftIn left;
  for (std::size_t i = 0; i < of.samples.size(); ++i) {
    if (of.samples[i].block != block && apart(of.samples[i].chip)) left.samples.push_back(i);
  }
  for (std::size_t i = 0; i < of.background.size(); ++i) {
    if (of.background_block[i] != block && apart(of.background[i])) left.background.push_back(of.background[i]);
  }
  return left;
}

/// One filter of one fold; fold `blocks` leaves nothing out.
struct FilterJob {
  std::size_t fold = 0;
  std::size_t bin = 0;
};

/// Thresholds of the other blocks applied to each, and precision over recall of all.
LandmarkQuality quality_of(const std::vector<JudgedHit>& judged, const std::vector<std::int64_t>& to_find) {
  LandmarkQuality quality;
  quality.blocks = static_cast<int>(to_find.size());
  std::int64_t all = 0;
  for (const std::int64_t count : to_find) all += count;
  quality.average_precision = average_precision(judged, all);
  quality.recall.of = all;
  for (std::size_t block = 0; block < to_find.size(); ++block) {
    std::vector<JudgedHit> others;
    std::copy_if(judged.begin(), judged.end(), std::back_inserter(others),
                 [&](const JudgedHit& hit) { return hit.block != block; });
    const double threshold = best_threshold(others, all - to_find[block]);
    for (const JudgedHit& hit : judged) {
      if (hit.block != block || hit.score < threshold) continue;
      ++quality.precision.of;
      quality.precision.count += hit.right ? 1 : 0;
      quality.recall.count += hit.right ? 1 : 0;
    }
  }
  return quality;
}

}  // namespace

TrainedLandmarks train_landmarks(const std::vector<std::string>& folders, const TrainOptions& options, int threads,
                                 std::uint64_t seed, const Progress& progress) {
  check_options(options);
  constexpr int kLeastCells = 5;  // fewer tell nothing
  const int cells = options.window_px / options.cell_px;
  if (options.window_px % options.cell_px != 0 || cells % 2 == 0 || cells < kLeastCells) {
    throw UsageError("window_px = " + std::to_string(options.window_px) + " is no odd multiple of cell_px = " +
                     std::to_string(options.cell_px) + " from " + std::to_string(kLeastCells) + " on");
  }
  const TrainingChips chips = read_training_chips(folders, progress);
  const CrsTransform transform(chips.crs);
  TrainedLandmarks result;
  const std::vector<std::string> names = class_names_of(chips);
  if (names.empty()) throw DataError(join(folders, ", ") + ": hold no label");
  std::vector<ClassSamples> classes;
  for (const std::string& name : names) {
    ClassSamples& of = classes.emplace_back(samples_of(chips, name));
    choose_geometry(options, of);
    cut_blocks(chips, static_cast<std::size_t>(options.blocks), of);
    if (of.too_small > 0) {
      result.warnings.push_back(name + ": " + std::to_string(of.too_small) + " labels are shorter than " +
                                format_number(kLeastLength_px) +
                                " px of the imagery and were not learnt; the first is " + of.first_too_small);
    }
    if (of.box_alone && options.heading_bins > 1) {
      result.warnings.push_back(name + ": its labels are boxes alone, whose sides were taken for their headings");
    }
    if (of.box_alone && options.heading_bins == 0) {
      result.warnings.push_back(name +
                                ": its labels are boxes alone, of which no heading is known: one filter for all");
    }
  }
  const auto blocks = static_cast<std::size_t>(options.blocks);
  std::int64_t jobs_in_all = 0;
  for (const ClassSamples& of : classes) jobs_in_all += static_cast<std::int64_t>((blocks + 1) * of.bins);
  std::int64_t jobs_done = 0;
  for (const ClassSamples& of : classes) {
    std::vector<FilterJob> jobs;
    for (std::size_t fold = 0; fold <= blocks; ++fold) {
      for (std::size_t bin = 0; bin < of.bins; ++bin) jobs.push_back({fold, bin});
    }
    std::vector<std::vector<std::vector<float>>> filters(blocks + 1, std::vector<std::vector<float>>(of.bins));
    std::vector<int> unobtainable(jobs.size(), 0);
    std::vector<LeftIn> left_in;
    for (std::size_t fold = 0; fold <= blocks; ++fold) left_in.push_back(without_block(chips, of, fold));
    std::mutex mutex;
    parallel_for(jobs.size(), threads, [&](std::size_t number, int) {
      const FilterJob& job = jobs[number];
      const LeftIn& left = left_in[job.fold];
      const double heading_deg = static_cast<double>(job.bin) * of.period_deg / static_cast<double>(of.bins);
      if (std::ssize(left.samples) >= kLeastLabels / 2) {
        filters[job.fold][job.bin] =
            train_filter(chips, of, left.samples, left.background, heading_deg, options, seed, unobtainable[number]);
      }
      const std::lock_guard lock(mutex);
      report_progress(progress, "training " + of.name, ++jobs_done, jobs_in_all);
    });

    std::vector<LandmarkDetector> of_fold;
    for (std::vector<std::vector<float>>& trained : filters) of_fold.push_back(detector_of(of, std::move(trained)));
    LearntDetector learnt{std::move(of_fold.back()), {}, {}};
    LandmarkDetector& detector = learnt.detector;
    const auto was_trained = [&](std::size_t block) { return !of_fold[block].filters.front().empty(); };
    detector.offset = usual_offset(chips, of, detector);
    // What it learnt it must find: the cheapest filter of all finds nothing.
    std::int64_t seen = 0;
    std::vector<JudgedHit> judged;
    std::vector<std::int64_t> to_find(blocks, 0);
    for (const Sample& sample : of.samples) {
      report_progress(progress, "judging " + of.name, jobs_done, jobs_in_all);
      std::vector<JudgedHit> own;
      judge_chip(chips, detector, sample, own);
      seen += std::any_of(own.begin(), own.end(), [](const JudgedHit& hit) { return hit.right && hit.score >= 0; });
      // A landmark on two dates is one trial: what finds it on one finds it on the other more often than not.
      if (!sample.first_of_place || !was_trained(sample.block)) continue;
      ++to_find[sample.block];
      judge_chip(chips, of_fold[sample.block], sample, judged);
    }
    for (std::size_t i = 0; i < of.background.size(); ++i) {
      report_progress(progress, "judging " + of.name, jobs_done, jobs_in_all);
      const std::size_t block = of.background_block[i];
      if (!was_trained(block)) continue;
      for (const LandmarkHit& hit :
           detect_landmarks(of_fold[block], chips.chips[of.background[i]].gray, chips.gsd_m, kLeastScore)) {
        judged.push_back({hit.score, false, block});
      }
    }
    if (seen == 0) {
      throw DataError(of.name + ": the detector finds none of the " + std::to_string(of.samples.size()) +
                      " labels that it learnt: they do not look alike. Split them into classes of one form and size, "
                      "give more --heading-bins where they have a heading, or a larger --c");
    }
    for (const Sample& sample : of.samples) {
      const auto place = transform.geodetic_from_map(sample.center_m);
      if (place && sample.first_of_place) learnt.places.push_back(*place);
    }
    learnt.quality = quality_of(judged, to_find);
    if (learnt.quality.recall.of < std::ssize(learnt.places)) {
      result.warnings.push_back(
          of.name + ": " + std::to_string(learnt.quality.recall.of) + " of " + std::to_string(learnt.places.size()) +
          " landmarks could be left out: the chips of the others share ground with all that would "
          "have been learnt without them");
    }
    detector.threshold = best_threshold(judged, learnt.quality.recall.of);
    if (!std::isfinite(detector.threshold)) detector.threshold = 0;
    int left_out = 0;
    for (std::size_t number = 0; number < jobs.size(); ++number) {
      if (jobs[number].fold == blocks) left_out = std::max(left_out, unobtainable[number] / (options.copies + 1));
    }
    if (left_out > 0) {
      result.warnings.push_back(of.name + ": " + std::to_string(left_out) +
                                " labels are too small beside the others to be learnt with them; a class of their own "
                                "would have a window of their size");
    }
    result.unobtainable.push_back(left_out);
    result.model.detectors.push_back(std::move(learnt));
  }
  return result;
}

}  // namespace pilotage
