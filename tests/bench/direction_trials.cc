// How often the directions of edges alone find a frame of another date on chips, and how often the correlation of local
// contrast alone does. docs/decisions/directions.md has the results.
//
//   bench_direction_trials MAP FRAMES [--side-px 84] [--trials 60] [--tolerance-px 5] [--seed 1]
//
// MAP and FRAMES show the same ground on the same grid at two dates; pixels that are 0 in either are not known. Frames
// are squares of FRAMES, turned by σ 1.2°, scaled by σ 3 %, of another gain and offset, with noise of 2.5; the window
// reaches 58 px to each side of a prior that is up to 46 px off. Beyond: the same frames in a window of the map at
// least 208 px off. Chips are of half the pixels, in 16 steps of gray.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/match/chip_search.h"
#include "pilotage/match/direction_search.h"
#include "pilotage/match/reduced_picture.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

constexpr int kWindow_px = 58;
constexpr double kPrior_px = 46;
constexpr int kBeyond_px = 150 + kWindow_px;
constexpr int kFactor = 2;  // pixels along a side of one of the chips'
constexpr int kChipSide = 32;
constexpr double kExclusion_px = 20;

struct Settings {
  std::vector<std::string> rasters;  // map, frames
  int side_px = 84;
  int trials = 60;
  double tolerance_px = 5;
  int seed = 1;
};

struct Pair {
  cv::Mat map;
  cv::Mat frames;
  cv::Mat known;
};

Pair open_pair(const Settings& settings) {
  std::vector<cv::Mat> pictures;
  for (const std::string& raster : settings.rasters) {
    const GraySource source = stretch_to_8bit(open_gray(raster));
    pictures.push_back(
        source.read({0, 0, static_cast<int>(source.width_px), static_cast<int>(source.height_px)}).pixels.clone());
  }
  if (pictures[0].size() != pictures[1].size()) throw DataError("both rasters must be of one size");
  Pair pair{pictures[0], pictures[1], (pictures[0] > 0) & (pictures[1] > 0)};
  cv::morphologyEx(pair.known, pair.known, cv::MORPH_CLOSE, cv::getStructuringElement(cv::MORPH_RECT, {9, 9}));
  return pair;
}

bool is_known(const Pair& pair, const cv::Rect& rect, double share) {
  return (rect & cv::Rect({0, 0}, pair.known.size())) == rect &&
         cv::countNonZero(pair.known(rect)) >= share * rect.area();
}

/// As chips hold it.
cv::Mat in_steps_of_gray(cv::Mat picture) {
  for (int y = 0; y < picture.rows; y += kChipSide) {
    for (int x = 0; x < picture.cols; x += kChipSide) {
      cv::Mat chip = picture(cv::Rect(x, y, kChipSide, kChipSide) & cv::Rect({0, 0}, picture.size()));
      double low = 0;
      double high = 0;
      cv::minMaxLoc(chip, &low, &high);
      const double step = std::max((high - low) / 15, 1.0);
      for (auto it = chip.begin<std::uint8_t>(); it != chip.end<std::uint8_t>(); ++it) {
        *it = cv::saturate_cast<std::uint8_t>(std::round((*it - low) / step) * step + low);
      }
    }
  }
  return picture;
}

ChipMosaic window_of(const Pair& pair, const cv::Rect& rect) {
  ChipMosaic mosaic;
  mosaic.gray = in_steps_of_gray(reduced_picture(pair.map(rect), kFactor));
  mosaic.valid = reduced_picture(pair.known(rect), kFactor) > 250;
  mosaic.first_col_px = rect.x;
  mosaic.first_row_px = rect.y;
  mosaic.factor = kFactor;
  return mosaic;
}

RectifiedFrame frame_of(const Pair& pair, const Vector2d& center_px, int side_px, Random& random) {
  const double turn = std::clamp(1.2 * random.normal(), -3.0, 3.0) * kRadPerDeg;
  const double scale = std::clamp(1 + 0.03 * random.normal(), 0.93, 1.07);
  const double c = scale * std::cos(turn);
  const double s = scale * std::sin(turn);
  const double middle = (side_px - 1) / 2.0;
  const cv::Matx23d map(c, -s, center_px.x() - c * middle + s * middle, s, c, center_px.y() - s * middle - c * middle);
  cv::Mat gray;
  cv::warpAffine(pair.frames, gray, map, {side_px, side_px}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REFLECT_101);
  const double gain = random.uniform(0.85, 1.1);
  const double offset = random.uniform(-8, 8);
  for (auto it = gray.begin<std::uint8_t>(); it != gray.end<std::uint8_t>(); ++it) {
    *it = cv::saturate_cast<std::uint8_t>(gain * *it + offset + 2.5 * random.normal());
  }
  RectifiedFrame frame;
  frame.status = RectifyStatus::kOk;
  frame.gray = reduced_picture(gray, kFactor);
  frame.valid = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(255));
  frame.gsd_m = 1;
  frame.origin_m = {-frame.gray.cols / 2.0, frame.gray.rows / 2.0};
  return frame;
}

/// What one way to compare made of all trials.
struct Outcomes {
  const char* name;
  int right = 0;
  std::vector<double> of_right{};
  std::vector<double> beyond{};
  double seconds = 0;

  void add(bool is_beyond, double value, bool is_right) {
    if (is_beyond) {
      beyond.push_back(value);
    } else if (is_right) {
      ++right;
      of_right.push_back(value);
    }
  }
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

void tell(const Outcomes& one, int trials) {
  const double most = quantile(one.beyond, 1);
  const auto above =
      std::count_if(one.of_right.begin(), one.of_right.end(), [&](double value) { return value > most; });
  std::printf(
      "%-12s right %d of %d, %td of them above all that lies beyond; value of right places %.1f in the median, "
      "beyond %.1f, %.1f at 90 %%, at most %.1f; %.1f ms each\n",
      one.name, one.right, trials, above, quantile(one.of_right, 0.5), quantile(one.beyond, 0.5),
      quantile(one.beyond, 0.9), most, 1000 * one.seconds / (2.0 * trials));
}

template <class Search>
void time_of(Outcomes& outcomes, const Search& search) {
  const auto start = std::chrono::steady_clock::now();
  search();
  outcomes.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void try_window(const RectifiedFrame& frame, const ChipMosaic& mosaic, const Vector2d& window_px,
                const std::optional<Vector2d>& truth_px, double tolerance_px, Outcomes& directions,
                Outcomes& contrast) {
  const auto is_right = [&](const Vector2d& place_px) {
    return truth_px && (place_px - *truth_px).norm() <= tolerance_px + kFactor;
  };
  time_of(directions, [&] {
    const auto surface = search_directions(frame, mosaic, window_px, kWindow_px, {-2, 0, 2});
    if (!surface) return directions.add(!truth_px, 0, false);
    const auto places = direction_places(*surface, 1, kExclusion_px);
    if (places.empty()) return directions.add(!truth_px, 0, false);
    directions.add(!truth_px, places.front().agreement, is_right(places.front().nadir_px));
  });
  time_of(contrast, [&] {
    const ChipMatch match = search_chips(frame, mosaic, window_px, kWindow_px, chip_hypotheses(2, 3, 0.045, 3));
    contrast.add(!truth_px, match.ncc * std::sqrt(match.pixels), match.found && is_right(match.nadir_px));
  });
}

void run(const Settings& settings) {
  const Pair pair = open_pair(settings);
  Random random(static_cast<std::uint64_t>(settings.seed));
  Outcomes directions{"directions"};
  Outcomes contrast{"contrast"};
  const int side = settings.side_px;
  const int window_side = (side + 2 * kWindow_px + 1) / 2 * 2;
  const auto window_about = [&](const Vector2d& px) {
    const auto begin = [&](double at) { return static_cast<int>(std::lround(at - window_side / 2.0)) / 2 * 2; };
    return cv::Rect(begin(px.x()), begin(px.y()), window_side, window_side);
  };
  const auto anywhere = [&] { return Vector2d(random.uniform(0, pair.map.cols), random.uniform(0, pair.map.rows)); };
  int done = 0;
  for (int attempt = 0; done < settings.trials && attempt < 1000 * settings.trials; ++attempt) {
    const Vector2d truth_px = anywhere();
    const Vector2d prior_px =
        truth_px + Vector2d(random.uniform(-kPrior_px, kPrior_px), random.uniform(-kPrior_px, kPrior_px));
    const Vector2d far_px = anywhere();
    const int reach = static_cast<int>(0.6 * side);
    const cv::Rect shown(static_cast<int>(truth_px.x()) - reach, static_cast<int>(truth_px.y()) - reach, 2 * reach,
                         2 * reach);
    const cv::Rect near = window_about(prior_px);
    const cv::Rect far = window_about(far_px);
    if (!is_known(pair, shown, 0.98) || !is_known(pair, near, 0.9) || !is_known(pair, far, 0.95)) continue;
    if ((far_px - truth_px).cwiseAbs().maxCoeff() < kBeyond_px) continue;
    ++done;
    const RectifiedFrame frame = frame_of(pair, truth_px, side, random);
    // Positions are outer corners; the frame's middle lies on a pixel's middle.
    const Vector2d half(0.5, 0.5);
    try_window(frame, window_of(pair, near), prior_px + half, truth_px + half, settings.tolerance_px, directions,
               contrast);
    try_window(frame, window_of(pair, far), far_px + half, std::nullopt, settings.tolerance_px, directions, contrast);
  }
  if (done < settings.trials) throw DataError("there is no room for so many trials");
  tell(directions, done);
  tell(contrast, done);
}

Settings settings_of(const std::vector<std::string>& words) {
  Settings settings;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (!word.starts_with("--")) {
      settings.rasters.push_back(word);
      continue;
    }
    if (i + 1 == words.size()) throw UsageError(word + " wants a value");
    const double value = std::atof(words[++i].c_str());
    if (word == "--side-px") {
      settings.side_px = static_cast<int>(value);
    } else if (word == "--trials") {
      settings.trials = static_cast<int>(value);
    } else if (word == "--tolerance-px") {
      settings.tolerance_px = value;
    } else if (word == "--seed") {
      settings.seed = static_cast<int>(value);
    } else {
      throw UsageError("unknown option " + word);
    }
  }
  if (settings.rasters.size() != 2) throw UsageError("bench_direction_trials MAP FRAMES [--side-px N] [--trials N] …");
  if (settings.side_px < 32 || settings.trials < 1) throw UsageError("--side-px must be 32 at least, --trials 1");
  return settings;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  try {
    pilotage::run(pilotage::settings_of({argv + 1, argv + argc}));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
