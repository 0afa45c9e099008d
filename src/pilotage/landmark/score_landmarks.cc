#include "pilotage/landmark/score_landmarks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/detections.h"
#include "pilotage/landmark/landmark_label.h"
#include "pilotage/landmark/outline.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

constexpr int kBlock_px = 1024;

/// A hit on the ground.
struct GroundHit {
  Vector2d center_m{0, 0};
  double length_m = 0;
  double score = 0;
};

/// Labels of one class with their middles.
struct ClassLabel {
  const LandmarkLabel* label = nullptr;
  Vector2d center_m{0, 0};
  double length_m = 0;
};

/// The search's grid: whole pixels of `gsd_m` over all imagery.
struct SearchGrid {
  GeoTransform map_from_pixel;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
};

SearchGrid grid_over(const Bounds& bounds, double gsd_m) {
  return {GeoTransform::north_up(bounds.min_x_m, bounds.max_y_m, gsd_m),
          static_cast<std::int64_t>(std::ceil(bounds.width_m() / gsd_m)),
          static_cast<std::int64_t>(std::ceil(bounds.height_m() / gsd_m))};
}

struct Found {
  std::vector<GroundHit> hits;  ///< Strongest first.
  double area_km2 = 0;          ///< Valid ground.
};

/// Every hit on the imagery. Blocks overlap by the largest window; what two blocks see at the same place, at their
/// border, counts once.
Found search(const LandmarkDetector& detector, const std::vector<std::string>& imagery, const ImageryOptions& options,
             const Crs& crs, const Bounds& bounds, int threads, const Progress& progress) {
  const SearchGrid grid = grid_over(bounds, detector.gsd_m);
  const GraySource source =
      stretch_to_8bit(open_gray_on_grid(imagery, crs, grid.map_from_pixel, grid.width_px, grid.height_px, options));
  const int margin_px =
      static_cast<int>(std::ceil(detector.context * detector.longest_m / detector.gsd_m)) + detector.window.side_px;
  // Two blocks see what lies at their border on different cells; either may see it beyond, so both say it.
  const double reach_px = detector.window.cell_px * std::pow(kFhogPyramidStep, detector.window.levels - 1);
  const std::int64_t columns = (grid.width_px + kBlock_px - 1) / kBlock_px;
  const std::int64_t rows = (grid.height_px + kBlock_px - 1) / kBlock_px;
  std::vector<Found> blocks(static_cast<std::size_t>(columns * rows));
  std::int64_t done = 0;
  std::mutex mutex;
  parallel_for(blocks.size(), threads, [&](std::size_t number, int) {
    const std::int64_t core_col = static_cast<std::int64_t>(number) % columns * kBlock_px;
    const std::int64_t core_row = static_cast<std::int64_t>(number) / columns * kBlock_px;
    const std::int64_t col = std::max<std::int64_t>(core_col - margin_px, 0);
    const std::int64_t row = std::max<std::int64_t>(core_row - margin_px, 0);
    const std::int64_t end_col = std::min(core_col + kBlock_px + margin_px, grid.width_px);
    const std::int64_t end_row = std::min(core_row + kBlock_px + margin_px, grid.height_px);
    Raster read = source.read({col, row, static_cast<int>(end_col - col), static_cast<int>(end_row - row)});
    const cv::Rect core(static_cast<int>(core_col - col), static_cast<int>(core_row - row),
                        static_cast<int>(std::min<std::int64_t>(kBlock_px, grid.width_px - core_col)),
                        static_cast<int>(std::min<std::int64_t>(kBlock_px, grid.height_px - core_row)));
    const int valid = cv::countNonZero(read.valid(core));
    blocks[number].area_km2 = valid * detector.gsd_m * detector.gsd_m * 1e-6;
    if (valid > 0) {
      read.pixels.setTo(cv::mean(read.pixels, read.valid), ~read.valid);
      for (const LandmarkHit& hit : detect_landmarks(detector, read.pixels, detector.gsd_m, kLeastScore)) {
        const Vector2d px(hit.center_px.x(), hit.center_px.y());
        const bool inside = px.x() >= core.x - reach_px && px.x() < core.x + core.width + reach_px &&
                            px.y() >= core.y - reach_px && px.y() < core.y + core.height + reach_px && px.x() >= 0 &&
                            px.y() >= 0 && px.x() < read.valid.cols && px.y() < read.valid.rows;
        if (!inside || read.valid.at<std::uint8_t>(static_cast<int>(px.y()), static_cast<int>(px.x())) == 0) continue;
        const Vector2d place =
            grid.map_from_pixel.map_from_pixel(px + Vector2d(static_cast<double>(col), static_cast<double>(row)));
        blocks[number].hits.push_back({place, hit.length_px * detector.gsd_m, hit.score});
      }
    }
    const std::lock_guard lock(mutex);
    report_progress(progress, "looking for " + detector.class_name, ++done, static_cast<std::int64_t>(blocks.size()));
  });
  Found all;
  for (Found& block : blocks) {
    all.area_km2 += block.area_km2;
    all.hits.insert(all.hits.end(), block.hits.begin(), block.hits.end());
  }
  std::stable_sort(all.hits.begin(), all.hits.end(),
                   [](const GroundHit& a, const GroundHit& b) { return a.score > b.score; });
  // The strongest at each place: only hits in the cells around can be at the same.
  double cell_m = detector.gsd_m;
  for (const GroundHit& hit : all.hits) cell_m = std::max(cell_m, kSamePlace * hit.length_m);
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> cells;
  std::vector<GroundHit> once;
  for (const GroundHit& hit : all.hits) {
    const auto x = static_cast<std::int64_t>(std::floor(hit.center_m.x() / cell_m));
    const auto y = static_cast<std::int64_t>(std::floor(hit.center_m.y() / cell_m));
    bool again = false;
    for (std::int64_t step = 0; step < 9 && !again; ++step) {
      const auto near = cells.find({x + step % 3 - 1, y + step / 3 - 1});
      if (near == cells.end()) continue;
      again = std::any_of(near->second.begin(), near->second.end(), [&](std::size_t number) {
        const GroundHit& other = once[number];
        return (hit.center_m - other.center_m).norm() < kSamePlace * std::max(hit.length_m, other.length_m);
      });
    }
    if (again) continue;
    cells[{x, y}].push_back(once.size());
    once.push_back(hit);
  }
  all.hits = std::move(once);
  return all;
}

/// The labels of a class whose middles the imagery shows.
std::vector<ClassLabel> shown_labels(const std::vector<LandmarkLabel>& labels, const std::string& class_name,
                                     const GraySource& valid, const ImageryDates& dates, LandmarkScores& scores) {
  std::vector<ClassLabel> shown;
  for (const LandmarkLabel& label : labels) {
    if (label.class_name != class_name || label.ignore) continue;
    if (!date_misfit(label, dates).empty()) {
      ++scores.other_date;
      continue;
    }
    const OrientedBox box = oriented_box(label.outline_m);
    const Vector2d px = valid.map_from_pixel.pixel_from_map(box.center);
    const bool inside = px.x() >= 0 && px.y() >= 0 && px.x() < static_cast<double>(valid.width_px) &&
                        px.y() < static_cast<double>(valid.height_px);
    const auto is_valid = [&] {
      const PixelWindow window{static_cast<std::int64_t>(px.x()), static_cast<std::int64_t>(px.y()), 1, 1};
      return cv::countNonZero(valid.read(window).valid) > 0;
    };
    if (inside && is_valid()) {
      shown.push_back({&label, box.center, box.length});
    } else {
      ++scores.outside;
    }
  }
  return shown;
}

double ambiguity_of(const ClassLabel& label, const std::vector<ClassLabel>& all, double p_detect,
                    double false_alarms_per_m2, double radius_m) {
  const auto others = std::count_if(all.begin(), all.end(), [&](const ClassLabel& other) {
    return &other != &label && (other.center_m - label.center_m).norm() <= radius_m;
  });
  return static_cast<double>(others) * p_detect + false_alarms_per_m2 * std::numbers::pi * radius_m * radius_m;
}

std::vector<Vector2d> learnt_places(const LearntDetector& learnt, const CrsTransform& transform) {
  std::vector<Vector2d> places;
  for (const GeodeticPoint& place : learnt.places) {
    if (const auto at = transform.map_from_geodetic(place)) places.push_back(*at);
  }
  return places;
}

void score_class(const LearntDetector& learnt_detector, const std::vector<ClassLabel>& labels,
                 const std::vector<ClassLabel>& ignored, const Found& found, double search_radius_m,
                 const CrsTransform& transform, LandmarkScores& scores) {
  std::vector<std::optional<GroundHit>> hit_of(labels.size());
  const LandmarkDetector& detector = learnt_detector.detector;
  const std::vector<Vector2d> learnt = learnt_places(learnt_detector, transform);
  std::vector<bool> taken(labels.size(), false);  // by a hit of any score: a label is found once
  std::vector<JudgedHit> judged;
  std::vector<GroundHit> false_alarms;
  for (const GroundHit& hit : found.hits) {
    std::optional<std::size_t> nearest;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const double distance_m = (hit.center_m - labels[i].center_m).norm();
      if (distance_m >= kSamePlace * labels[i].length_m) continue;
      if (!nearest || distance_m < (hit.center_m - labels[*nearest].center_m).norm()) nearest = i;
    }
    const bool on_ignored = std::any_of(ignored.begin(), ignored.end(), [&](const ClassLabel& label) {
      return (hit.center_m - label.center_m).norm() < kSamePlace * label.length_m;
    });
    if (!nearest && on_ignored) continue;
    const bool right = nearest && !taken[*nearest];
    if (right) taken[*nearest] = true;
    judged.push_back({hit.score, right, 0});
    if (hit.score < detector.threshold) continue;
    if (right) {
      hit_of[*nearest] = hit;
    } else {
      false_alarms.push_back(hit);
    }
  }
  ScoredClass result;
  result.class_name = detector.class_name;
  result.average_precision = average_precision(judged, std::ssize(labels));
  result.false_alarms = {std::ssize(false_alarms), found.area_km2};
  result.recall.of = std::ssize(labels);
  std::vector<double> lengths_m;
  double squares = 0;
  std::vector<ScoredLandmark> rows;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    ScoredLandmark row;
    row.class_name = detector.class_name;
    row.place = transform.geodetic_from_map(labels[i].center_m).value_or(GeodeticPoint{kNaN, kNaN});
    row.length_m = labels[i].length_m;
    row.learnt = std::any_of(learnt.begin(), learnt.end(), [&](const Vector2d& place) {
      return (place - labels[i].center_m).norm() < kSamePlace * labels[i].length_m;
    });
    row.score = row.east_m = row.north_m = kNaN;
    if (!row.learnt) ++result.recall_elsewhere.of;
    if (hit_of[i]) {
      row.fate = LandmarkFate::kFound;
      row.score = hit_of[i]->score;
      row.east_m = hit_of[i]->center_m.x() - labels[i].center_m.x();
      row.north_m = hit_of[i]->center_m.y() - labels[i].center_m.y();
      lengths_m.push_back(std::hypot(row.east_m, row.north_m));
      squares += row.east_m * row.east_m + row.north_m * row.north_m;
      ++result.recall.count;
      if (!row.learnt) ++result.recall_elsewhere.count;
    }
    rows.push_back(row);
  }
  const double per_m2 = found.area_km2 > 0 ? result.false_alarms.value() * 1e-6 : 0;
  std::vector<double> ambiguities;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    rows[i].ambiguity = ambiguity_of(labels[i], labels, result.recall.value(), per_m2, search_radius_m);
    ambiguities.push_back(rows[i].ambiguity);
  }
  for (const GroundHit& hit : false_alarms) {
    ScoredLandmark row;
    row.class_name = detector.class_name;
    row.fate = LandmarkFate::kFalseAlarm;
    row.place = transform.geodetic_from_map(hit.center_m).value_or(GeodeticPoint{kNaN, kNaN});
    row.score = hit.score;
    row.length_m = hit.length_m;
    row.east_m = row.north_m = row.ambiguity = kNaN;
    rows.push_back(row);
  }
  result.median_ambiguity = quantile(ambiguities, 0.5);
  result.error_median_m = quantile(lengths_m, 0.5);
  result.error_95_m = quantile(lengths_m, 0.95);
  const double degrees = 2 * static_cast<double>(lengths_m.size());
  result.sigma_m = lengths_m.empty() ? kNaN : std::sqrt(squares / degrees);
  result.sigma_interval_m = {kNaN, kNaN};
  if (!lengths_m.empty()) {
    result.sigma_interval_m = {std::sqrt(squares / chi_squared_quantile(0.975, degrees)),
                               std::sqrt(squares / chi_squared_quantile(0.025, degrees))};
  }
  scores.classes.push_back(result);
  scores.landmarks.insert(scores.landmarks.end(), rows.begin(), rows.end());
}

}  // namespace

double Density::value() const {
  return area_km2 > 0 ? static_cast<double>(count) / area_km2 : kNaN;
}

Interval Density::interval() const {
  if (!(area_km2 > 0)) return {0, std::numeric_limits<double>::infinity()};
  const double low = count == 0 ? 0 : chi_squared_quantile(0.025, 2.0 * static_cast<double>(count)) / 2;
  const double high = chi_squared_quantile(0.975, 2.0 * static_cast<double>(count) + 2) / 2;
  return {low / area_km2, high / area_km2};
}

MapLandmarks landmarks_for_map(const LandmarkModel& model, const LandmarkScores& scores) {
  MapLandmarks landmarks;
  std::map<std::string, std::size_t> numbers;
  for (const ScoredClass& scored : scores.classes) {
    // What a few hits miss may be luck: the upper end of its interval is what the map says.
    const double sigma_m = scored.sigma_interval_m.high;
    if (scored.recall.count == 0 || !(sigma_m <= kLargestLandmarkSigma_m)) continue;
    const auto learnt = std::find_if(model.detectors.begin(), model.detectors.end(), [&](const LearntDetector& one) {
      return one.detector.class_name == scored.class_name;
    });
    numbers[scored.class_name] = landmarks.detectors.size();
    // Hits on the pixel, of a few landmarks, are no proof of more than that.
    constexpr double kLeastSigma_px = 0.1;
    landmarks.detectors.push_back({learnt->detector, scored.recall.value(), scored.false_alarms.value(),
                                   std::max(sigma_m, kLeastSigma_px * learnt->detector.gsd_m)});
  }
  for (const ScoredLandmark& scored : scores.landmarks) {
    const auto number = numbers.find(scored.class_name);
    if (scored.fate == LandmarkFate::kFalseAlarm || number == numbers.end()) continue;
    landmarks.landmarks.push_back({std::ssize(landmarks.landmarks), number->second, scored.place, scored.length_m, kNaN,
                                   scored.fate == LandmarkFate::kFound, scored.ambiguity});
  }
  return landmarks;
}

LandmarkScores score_landmarks(const LandmarkModel& model, const LandmarkScoreOptions& options, int threads,
                               const Progress& progress) {
  check_options(options);
  if (options.second_epoch.empty()) throw UsageError("second_epoch is missing; give --second-epoch IMAGERY");
  std::vector<ImageryInfo> infos;
  for (const std::string& dataset : options.second_epoch) {
    infos.push_back(inspect_imagery(dataset, options.imagery, progress));
  }
  LandmarkScores scores;
  scores.warnings = imagery_warnings(infos, 0);
  for (const ImageryInfo& info : infos) scores.acquired = std::max(scores.acquired, info.acquired);
  const std::vector<GeodeticPoint> middle{infos.front().center};
  const double half_m =
      std::hypot(infos.front().width_px * infos.front().gsd_x_m, infos.front().height_px * infos.front().gsd_y_m) / 2;
  scores.crs = options.crs.empty() ? choose_mission_crs(middle, half_m).crs
                                   : check_mission_crs(Crs::from_user_input(options.crs), middle, half_m).crs;
  const Bounds bounds = imagery_bounds(infos, scores.crs);
  const LandmarkLabels read = read_landmark_labels(options.labels, options.imagery.imagery_crs, scores.crs);
  const std::vector<LandmarkLabel>& labels = read.labels;
  scores.outside = std::ssize(read.nowhere);
  scores.warnings.insert(scores.warnings.end(), read.warnings.begin(), read.warnings.end());
  ImageryDates dates;
  for (const ImageryInfo& info : infos) dates.add(info.acquired);
  const SearchGrid metres = grid_over(bounds, 1);
  const GraySource valid = open_valid_on_grid(options.second_epoch, scores.crs, metres.map_from_pixel, metres.width_px,
                                              metres.height_px, options.imagery);
  const CrsTransform transform(scores.crs);
  bool any = false;
  for (const LearntDetector& learnt : model.detectors) {
    const LandmarkDetector& detector = learnt.detector;
    const bool known = std::any_of(labels.begin(), labels.end(),
                                   [&](const LandmarkLabel& label) { return label.class_name == detector.class_name; });
    if (!known) continue;
    any = true;
    const std::vector<ClassLabel> shown = shown_labels(labels, detector.class_name, valid, dates, scores);
    if (shown.empty()) {
      scores.warnings.push_back("no landmark of the class " + detector.class_name +
                                " is shown on imagery of its date: it was not looked for");
      continue;
    }
    std::vector<ClassLabel> ignored;
    for (const LandmarkLabel& label : labels) {
      if (!label.ignore || label.class_name != detector.class_name) continue;
      const OrientedBox box = oriented_box(label.outline_m);
      ignored.push_back({&label, box.center, box.length});
    }
    const Found found = search(detector, options.second_epoch, options.imagery, scores.crs, bounds, threads, progress);
    score_class(learnt, shown, ignored, found, options.search_radius_m, transform, scores);
  }
  if (!any) {
    std::vector<std::string> known;
    for (const LearntDetector& learnt : model.detectors) known.push_back(learnt.detector.class_name);
    throw DataError(join(options.labels.labels, ", ") +
                    ": no label is of a class that the model knows: " + join(known, ", "));
  }
  if (scores.classes.empty()) {
    throw DataError(options.second_epoch.front() + ": shows no landmark of the labels (" +
                    std::to_string(scores.outside) + " are elsewhere, " + std::to_string(scores.other_date) +
                    " of another date)");
  }
  return scores;
}

}  // namespace pilotage
