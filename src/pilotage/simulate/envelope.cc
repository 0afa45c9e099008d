#include "pilotage/simulate/envelope.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/planned_flight.h"
#include "pilotage/simulate/degraded_frame.h"
#include "pilotage/simulate/rendered_fixes.h"
#include "pilotage/simulate/rendered_world.h"
#include "pilotage/simulate/spoilt_frame.h"

namespace pilotage {
namespace {

constexpr std::size_t kMostValues = 1000;
constexpr double kLeastOfFrame = 0.9;  // that shows imagery
constexpr double kSureP = 0.5;
constexpr double kAsGood = 0.9;

/// What a thread keeps: the maps, and a camera for each world and GSD ratio.
struct EnvelopeWorker {
  std::vector<MapReader> maps;
  std::map<std::pair<std::size_t, double>, std::unique_ptr<WorldCamera>> cameras;
};

/// All that the cells share.
struct EnvelopeRun {
  const Mission& mission;
  const EnvelopeOptions& options;
  std::uint64_t seed;
  std::vector<RenderedWorld> worlds;
  Camera camera;  ///< Of the planned GSD.

  Camera camera_of(double gsd_ratio) const {
    const auto side = [&](int px) { return std::max(1, static_cast<int>(std::lround(px / gsd_ratio))); };
    return gsd_ratio == 1 ? camera : resized_camera(camera, side(camera.width_px), side(camera.height_px));
  }
};

/// Spoils a frame as the cell says (simulate/spoilt_frame.h); most cells spoil none.
void spoil(const EnvelopeCell& cell, double height_agl_m, const Random& random, cv::Mat& gray) {
  switch (cell.factor) {
    case EnvelopeFactor::kFog:
      return add_fog(gray, height_agl_m, cell.value, random);
    case EnvelopeFactor::kClouds:
      return add_clouds(gray, cell.value, random);
    case EnvelopeFactor::kDark:
      return take_in_the_dark(gray, cell.value, random);
    case EnvelopeFactor::kMotionBlur:
      return blur_by_motion(gray, {0, cell.value});
    case EnvelopeFactor::kDrops:
      return add_drops(gray, static_cast<int>(cell.value), random);
    case EnvelopeFactor::kJpeg:
      return compress(gray, static_cast<int>(cell.value));
    case EnvelopeFactor::kPlanned:
    case EnvelopeFactor::kHeight:
    case EnvelopeFactor::kHeading:
    case EnvelopeFactor::kGsdRatio:
    case EnvelopeFactor::kAttitudeError:
    case EnvelopeFactor::kPositionError:
      return;
  }
}

/// What came of one place in one cell.
struct PlaceOutcome {
  Outcome outcome = Outcome::kNotTried;
  double error_m = kNaN;  ///< Of a fix.
};

/// One place in one cell. Its random numbers are those of the place.
PlaceOutcome outcome_at(const EnvelopeRun& run, const EnvelopeCell& cell, std::size_t number,
                        const EnvelopePlace& place, EnvelopeWorker& worker) {
  const EnvelopeOptions& options = run.options;
  const FlightSample& sample = run.mission.flight.samples[place.sample];
  const auto varied = [&](EnvelopeFactor factor, double otherwise) {
    return cell.factor == factor ? cell.value : otherwise;
  };
  const double ratio = varied(EnvelopeFactor::kGsdRatio, 1);
  std::unique_ptr<WorldCamera>& camera = worker.cameras[{cell.world, ratio}];
  if (!camera) camera = std::make_unique<WorldCamera>(run.worlds[cell.world], run.camera_of(ratio));

  const std::uint64_t place_seed = derive_seed(run.seed, 1 + number);
  Random random(place_seed);
  CameraPose pose{sample.point, varied(EnvelopeFactor::kHeight, sample.agl_m), kNaN, {}};
  pose.attitude.yaw_deg = std::fmod(sample.azimuth_deg + varied(EnvelopeFactor::kHeading, 0) + 360, 360);
  pose.attitude.pitch_deg = options.tilt_sigma_deg * random.normal();
  pose.attitude.roll_deg = options.tilt_sigma_deg * random.normal();
  MatchPrior prior;
  const double position_sigma_m = varied(EnvelopeFactor::kPositionError, options.prior_sigma_m);
  const double east_m = position_sigma_m * random.normal();
  const double north_m = position_sigma_m * random.normal();
  prior.position = LocalFrame(pose.position).geodetic_from_enu({east_m, north_m, 0});
  prior.covariance_en_m2 = isotropic_covariance_m2(position_sigma_m);
  prior.height_agl_m = pose.height_agl_m * std::max(0.1, 1 + options.altimeter_sigma * random.normal());
  const double error_deg = varied(EnvelopeFactor::kAttitudeError, options.attitude_sigma_deg);
  prior.attitude = pose.attitude;
  prior.attitude.yaw_deg += error_deg * random.normal();
  prior.attitude.pitch_deg += error_deg * random.normal();
  prior.attitude.roll_deg += error_deg * random.normal();

  RenderedFrame frame = camera->frame_at(pose);
  if (frame.valid_fraction < kLeastOfFrame) return {};
  if (run.worlds[cell.world].of_the_map) FrameDegrader(options.degradation, random.next()).apply(frame.gray);
  spoil(cell, pose.height_agl_m, Random(derive_seed(place_seed, 1)), frame.gray);
  const MatchResult result = match(frame.gray, prior, camera->camera(), pointers_to(worker.maps), options.match);
  require_frame_was_tried(result, names_of(worker.maps));
  if (!result.fix) return {Outcome::kRefused};
  const double error_m = error_of_fix(*result.fix, pose.position, FrameTruth::kNadir).error_m;
  return {outcome_of_fix(error_m, options.correct_within_m), error_m};
}

std::vector<EnvelopeCell> empty_cells(const EnvelopeOptions& options, std::size_t worlds) {
  std::vector<EnvelopeCell> cells;
  const auto add = [&](EnvelopeFactor factor, double value, std::size_t world) {
    EnvelopeCell cell;
    cell.factor = factor;
    cell.value = value;
    cell.world = world;
    cells.push_back(cell);
  };
  const auto add_all = [&](EnvelopeFactor factor, const std::string& text, Range range, std::size_t world,
                           bool whole = false) {
    const std::vector<EnvelopeFactor>& tried = options.factors;
    const std::string name(options_detail::enum_to_name(factor));
    const std::vector<double> values = envelope_values(name, text, range);
    const bool is_named = std::find(tried.begin(), tried.end(), factor) != tried.end();
    if (!tried.empty() && !is_named) return;
    if (is_named && values.empty()) throw UsageError("factors names " + name + ", which has no values");
    for (const double value : values) {
      if (whole && value != std::floor(value)) {
        throw UsageError(name + " = \"" + text + "\": " + format_number(value) + " is no whole number");
      }
      add(factor, value, world);
    }
  };
  for (std::size_t world = 0; world < worlds; ++world) {
    add(EnvelopeFactor::kPlanned, 0, world);
    add_all(EnvelopeFactor::kHeight, options.height_m, {1, 100000}, world);
  }
  add_all(EnvelopeFactor::kHeading, options.heading_deg, {-360, 360}, 0);
  add_all(EnvelopeFactor::kGsdRatio, options.gsd_ratio, {0.1, 20}, 0);
  add_all(EnvelopeFactor::kAttitudeError, options.attitude_error_deg, {0, 45}, 0);
  add_all(EnvelopeFactor::kPositionError, options.position_error_m, {0.1, 10000}, 0);
  add_all(EnvelopeFactor::kFog, options.fog_visibility_m, {1, 1e6}, 0);
  add_all(EnvelopeFactor::kClouds, options.cloud_cover, {0, 1}, 0);
  add_all(EnvelopeFactor::kDark, options.dark_stops, {0, 20}, 0);
  add_all(EnvelopeFactor::kMotionBlur, options.motion_blur_px, {0, kMostMotion_px}, 0);
  add_all(EnvelopeFactor::kDrops, options.lens_drops, {0, 10000}, 0, true);
  add_all(EnvelopeFactor::kJpeg, options.jpeg_quality, {1, 100}, 0, true);
  return cells;
}

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

void count(const std::vector<PlaceOutcome>& outcomes, EnvelopeCell& cell) {
  for (const auto& [outcome, error_m] : outcomes) {
    cell.largest_error_m = std::fmax(cell.largest_error_m, error_m);
    if (outcome != Outcome::kNotTried) ++cell.frames;
    if (outcome == Outcome::kCorrect) ++cell.correct;
    if (outcome == Outcome::kFalse) ++cell.wrong;
  }
}

std::vector<std::string> envelope_notes(const std::vector<std::string>& worlds) {
  std::vector<std::string> notes = {
      "simulated: places under the route, frames rendered and matched one by one, not flights",
      "the error of the map against the world is the one that their georeferences have, none is drawn"};
  if (std::find(worlds.begin(), worlds.end(), "") != worlds.end()) {
    notes.emplace_back(
        "optimistic: frames show the very imagery that the map was made of, changed by a model of another "
        "day; give other dates with --world");
  }
  return notes;
}

/// The heights around the planned one up to which, without a gap, `holds`.
std::optional<Interval> reach(const std::vector<EnvelopeCell>& heights, double planned_m,
                              const std::function<bool(const EnvelopeCell&)>& holds) {
  Interval reached{planned_m, planned_m};
  for (const EnvelopeCell& cell : heights) {
    if (cell.value <= planned_m) continue;
    if (!holds(cell)) break;
    reached.high = cell.value;
  }
  for (auto cell = heights.rbegin(); cell != heights.rend(); ++cell) {
    if (cell->value >= planned_m) continue;
    if (!holds(*cell)) break;
    reached.low = cell->value;
  }
  return reached;
}

}  // namespace

std::vector<double> envelope_values(const std::string& name, const std::string& text, Range range) {
  const auto wrong = [&](const std::string& why) {
    return UsageError(name + " = \"" + text + "\": " + why + "; FIRST:LAST:STEP or numbers with commas are allowed");
  };
  const auto number = [&](const std::string& part) {
    const std::optional<double> value = parse_number(part);
    if (!value) throw wrong("\"" + part + "\" is no number");
    if (!(*value >= range.min && *value <= range.max)) {
      throw wrong(format_number(*value) + " is outside [" + format_number(range.min) + ", " + format_number(range.max) +
                  "]");
    }
    return *value;
  };
  std::vector<double> values;
  if (text.empty()) return values;
  if (const std::vector<std::string> parts = parts_of(text, ':'); parts.size() == 3) {
    const double first = number(parts[0]);
    const double last = number(parts[1]);
    const std::optional<double> step = parse_number(parts[2]);
    if (!step || !(*step > 0) || !(last >= first)) throw wrong("the step is not above 0, or the last below the first");
    if ((last - first) / *step >= static_cast<double>(kMostValues)) throw wrong("more than 1000 numbers");
    for (int i = 0; first + i * *step <= last + 1e-9 * *step; ++i) values.push_back(first + i * *step);
    return values;
  }
  for (const std::string& part : parts_of(text, ',')) values.push_back(number(part));
  if (values.size() > kMostValues) throw wrong("more than 1000 numbers");
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

std::vector<EnvelopePlace> envelope_places(const Mission& mission, const std::vector<TileScores>& scores,
                                           const Selection& selection, int count_wanted, std::uint64_t seed) {
  const std::vector<bool> stored = stored_tiles(mission, selection);
  const double interval_s = selection.tries ? selection.tries->interval_s : 0;
  std::vector<EnvelopePlace> all;
  std::vector<bool> taken(stored.size(), false);
  for (const FixAttempt& attempt : fix_attempts(mission, tiles_under_route(mission), interval_s,
                                                selection.tries ? selection.tries->decorrelation_m : std::nullopt)) {
    if (!stored[attempt.tile] || taken[attempt.tile]) continue;
    taken[attempt.tile] = true;
    const double p = scores[attempt.tile].p_correct_fix;
    all.push_back({mission.ground.tiles[attempt.tile].tile_id, std::isnan(p) ? 1 : p, attempt.sample});
  }
  if (all.empty()) throw DataError("no stored tile lies under the route: there is no place to look at");
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.p < b.p; });
  const std::size_t strata = std::min(all.size(), static_cast<std::size_t>(count_wanted));
  Random random(derive_seed(seed, 0));
  std::vector<EnvelopePlace> places;
  for (std::size_t i = 0; i < strata; ++i) {
    const std::size_t begin = i * all.size() / strata;
    const std::size_t end = (i + 1) * all.size() / strata;
    places.push_back(all[begin + random.below(end - begin)]);
  }
  return places;
}

HeightMargin height_margin(const std::vector<EnvelopeCell>& cells, std::size_t world, double planned_height_m) {
  HeightMargin margin;
  margin.world = world;
  std::vector<EnvelopeCell> heights;
  EnvelopeCell planned;
  for (const EnvelopeCell& cell : cells) {
    if (cell.world != world) continue;
    if (cell.factor == EnvelopeFactor::kPlanned) planned = cell;
    if (cell.factor == EnvelopeFactor::kHeight) heights.push_back(cell);
  }
  margin.planned_p = planned.p();
  const auto is_sure = [](const EnvelopeCell& cell) { return cell.correct_share().interval().low >= kSureP; };
  if (is_sure(planned)) margin.sure_m = reach(heights, planned_height_m, is_sure);
  if (planned.correct > 0) {
    margin.as_good_m = reach(heights, planned_height_m,
                             [&](const EnvelopeCell& cell) { return cell.p() >= kAsGood * margin.planned_p; });
  }
  return margin;
}

Envelope make_envelope(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                       const OpenMaps& open_maps, const EnvelopeOptions& options, std::uint64_t seed, int threads,
                       const Progress& progress) {
  check_options(options);
  if (options.match.deadline_ms) {
    throw UsageError("match_deadline_ms: what is simulated must not depend on how fast this machine is");
  }
  Envelope envelope;
  envelope.options = options;
  envelope.seed = seed;
  envelope.worlds = options.world.empty() ? std::vector<std::string>{""} : options.world;
  envelope.cells = empty_cells(options, envelope.worlds.size());
  envelope.places = envelope_places(mission, scores, selection, options.places, seed);
  std::vector<double> heights_m;
  for (const EnvelopePlace& place : envelope.places) heights_m.push_back(mission.flight.samples[place.sample].agl_m);
  envelope.planned_height_m = quantile(heights_m, 0.5);

  RenderedOptions rendered;
  rendered.frame_width_px = options.frame_width_px;
  EnvelopeRun run{mission, options, seed, {}, rendered_camera(mission, rendered)};
  envelope.frame_width_px = run.camera.width_px;
  for (const std::string& world : envelope.worlds) run.worlds.push_back(make_rendered_world(mission, world));
  std::vector<std::vector<PlaceOutcome>> outcomes(envelope.cells.size(),
                                                  std::vector<PlaceOutcome>(envelope.places.size()));
  std::vector<std::unique_ptr<EnvelopeWorker>> workers(static_cast<std::size_t>(thread_count(threads)));
  std::mutex reporting;
  std::int64_t done = 0;
  const std::size_t total = envelope.cells.size() * envelope.places.size();
  parallel_for(total, threads, [&](std::size_t index, int number) {
    std::unique_ptr<EnvelopeWorker>& worker = workers[static_cast<std::size_t>(number)];
    if (!worker) worker = std::make_unique<EnvelopeWorker>(EnvelopeWorker{open_maps(), {}});
    const std::size_t cell = index / envelope.places.size();
    const std::size_t place = index % envelope.places.size();
    outcomes[cell][place] = outcome_at(run, envelope.cells[cell], place, envelope.places[place], *worker);
    const std::lock_guard lock(reporting);
    report_progress(progress, "matching", ++done, static_cast<std::int64_t>(total));
  });
  for (std::size_t cell = 0; cell < outcomes.size(); ++cell) count(outcomes[cell], envelope.cells[cell]);
  const bool varies_height = std::any_of(envelope.cells.begin(), envelope.cells.end(), [](const EnvelopeCell& cell) {
    return cell.factor == EnvelopeFactor::kHeight;
  });
  for (std::size_t world = 0; varies_height && world < envelope.worlds.size(); ++world) {
    envelope.margins.push_back(height_margin(envelope.cells, world, envelope.planned_height_m));
  }
  envelope.notes = envelope_notes(envelope.worlds);
  return envelope;
}

}  // namespace pilotage
