#include "pilotage/report/seen_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "pilotage/base/parallel.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr int kJpegBlock_px = 8;
constexpr int kNothingSeen = 192;  // gray, as in the pictures of tiles

// The samples nearest to the middles of equal stretches, each once.
std::vector<std::size_t> places_to_look_at(const std::vector<FlightSample>& samples) {
  std::vector<std::size_t> places;
  if (samples.empty()) return places;
  const double length_m = samples.back().distance_m;
  for (std::size_t k = 0; k < kMostSeenFrames; ++k) {
    const double at_m = length_m * (static_cast<double>(k) + 0.5) / static_cast<double>(kMostSeenFrames);
    auto next = std::lower_bound(samples.begin(), samples.end(), at_m,
                                 [](const FlightSample& a, double b_m) { return a.distance_m < b_m; });
    if (next != samples.begin() && (next == samples.end() || at_m - (next - 1)->distance_m < next->distance_m - at_m)) {
      --next;
    }
    const auto place = static_cast<std::size_t>(next - samples.begin());
    const bool known = next->level != FlightSample::kNoLevel && next->agl_m > 0;
    if (known && (places.empty() || places.back() != place)) places.push_back(place);
  }
  return places;
}

int whole_blocks_px(int extent_px) {
  return (extent_px + kJpegBlock_px - 1) / kJpegBlock_px * kJpegBlock_px;
}

}  // namespace

SeenFrames render_seen_frames(const Mission& mission, const OpenLevel& open, int threads, const Progress& progress) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  const std::vector<std::size_t> places = places_to_look_at(samples);
  if (places.empty()) return {};
  const Camera& own = mission.flight.camera;
  const double scale = static_cast<double>(kSeenFrameSide_px) / std::max(own.width_px, own.height_px);
  const auto scaled = [&](int extent_px) { return std::max(1, static_cast<int>(std::lround(extent_px * scale))); };
  const Camera camera = resized_camera(own, scaled(own.width_px), scaled(own.height_px));

  std::map<int, GraySource> grounds;
  for (const std::size_t place : places) {
    const int level = samples[place].level;
    if (!grounds.contains(level)) grounds[level] = open(mission.ground.levels[static_cast<std::size_t>(level)]);
  }
  SeenFrames seen;
  seen.width_px = camera.width_px;
  seen.height_px = camera.height_px;
  seen.step_x_px = whole_blocks_px(camera.width_px);
  seen.step_y_px = whole_blocks_px(camera.height_px);
  seen.columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(places.size())))));
  const int rows = (static_cast<int>(places.size()) + seen.columns - 1) / seen.columns;
  seen.sheet = cv::Mat(rows * seen.step_y_px, seen.columns * seen.step_x_px, CV_8UC1, cv::Scalar(kNothingSeen));
  seen.frames.resize(places.size());
  std::mutex mutex;
  std::int64_t done = 0;
  parallel_for(places.size(), threads, [&](std::size_t i, int) {
    const FlightSample& sample = samples[places[i]];
    const GraySource& ground = grounds.at(sample.level);
    const GroundPlace over = ground_place(mission.ground.crs, ground.map_from_pixel,
                                          ground.map_from_pixel.pixel_from_map(sample.point_map_m));
    const RenderedFrame frame = render_frame(ground, over, camera, {sample.azimuth_deg, 0, 0}, sample.agl_m);
    seen.frames[i] = {sample.distance_m, sample.azimuth_deg, sample.agl_m,
                      sample.agl_m * camera.width_px / camera.fx_px, tile_under(mission, sample)};
    frame.gray.copyTo(seen.sheet(seen.place(i)), frame.valid);
    const std::lock_guard lock(mutex);
    report_progress(progress, "frames along the route", ++done, static_cast<std::int64_t>(places.size()));
  });
  return seen;
}

OpenLevel open_own_imagery(const Mission& mission) {
  return [&mission](const GridLevel& level) { return stretch_to_8bit(open_gray(mission.ground, level)); };
}

}  // namespace pilotage
