#include "pilotage/report/landmark_note.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "pilotage/base/angle.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/match/landmark_matching.h"
#include "pilotage/match/match.h"
#include "pilotage/match/match_confidence.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector2d;

/// Landmarks on the grid of the ground, sorted from left to right.
struct GroundLandmark {
  Vector2d point_m{0, 0};
  std::size_t index = 0;  ///< Of MapLandmarks::landmarks.
};

/// A frame about the middle of a tile.
struct FrameLandmarks {
  std::vector<std::size_t> shown;  ///< Indices of MapLandmarks::landmarks.
  double p_fix = 0;
};

class Prospects {
 public:
  Prospects(const Mission& mission, const MapLandmarks& landmarks) : mission_(mission), landmarks_(landmarks) {
    const CrsTransform transform(mission.ground.crs);
    for (std::size_t i = 0; i < landmarks.landmarks.size(); ++i) {
      const auto point_m = transform.map_from_geodetic(landmarks.landmarks[i].place);
      if (point_m) on_grid_.push_back({*point_m, i});
    }
    std::stable_sort(on_grid_.begin(), on_grid_.end(),
                     [](const GroundLandmark& a, const GroundLandmark& b) { return a.point_m.x() < b.point_m.x(); });
  }

  FrameLandmarks view_of(const GroundTile& tile) const {
    const Bounds& bounds = tile.bounds;
    const Vector2d middle_m((bounds.min_x_m + bounds.max_x_m) / 2, (bounds.min_y_m + bounds.max_y_m) / 2);
    const double radius_m = std::min(bounds.max_x_m - bounds.min_x_m, bounds.max_y_m - bounds.min_y_m) / 2;
    const GridLevel& level = mission_.ground.level_of(tile);
    const double half_width_m =
        mission_.flight.max_error_m + 2 * level.max_agl_m * std::tan(options_.attitude_sigma_deg * kRadPerDeg);
    const double reach_m = std::numbers::sqrt2 * half_width_m + 1.2 * radius_m;
    const double gsd_m = level.gsd_m;

    FrameLandmarks view;
    LandmarkSearch search;
    std::vector<std::size_t> numbers;
    std::vector<double> counts(landmarks_.detectors.size(), 0);
    for (const GroundLandmark& one : within(middle_m, reach_m)) {
      const MapLandmark& landmark = landmarks_.landmarks[one.index];
      NearLandmark near;
      near.detector = landmark.detector;
      near.map_px = (one.point_m - middle_m) / gsd_m;
      search.near.push_back(near);
      numbers.push_back(one.index);
      counts[landmark.detector] += 1;
    }
    if (search.near.empty() || search.near.size() > kMaxNearLandmarks) return view;
    group_landmarks(kLandmarkGroup_m / gsd_m, search.near);

    std::vector<LandmarkPair> pairs;         // if all are seen
    std::map<std::size_t, double> p_unseen;  // of groups that the frame may see
    for (std::size_t i = 0; i < search.near.size(); ++i) {
      const MapLandmark& landmark = landmarks_.landmarks[numbers[i]];
      const MapDetector& detector = landmarks_.detectors[landmark.detector];
      const double half_side_m = 0.5 * detector.detector.context * landmark.length_m;
      if (!landmark.found || search.near[i].map_px.norm() * gsd_m + half_side_m > radius_m) continue;
      view.shown.push_back(numbers[i]);
      search.sightings.push_back({landmark.detector, {radius_m / gsd_m, 0}});
      pairs.push_back({pairs.size(), i});
      p_unseen.emplace(search.near[i].group, 1.0).first->second *= 1 - p_seen_on_frame(detector);
    }
    if (p_unseen.size() < kLeastLandmarks) return view;
    const double frame_km2 = std::numbers::pi * radius_m * radius_m * 1e-6;
    search.landmarks_in_px2 =
        landmark_densities(search.near, landmarks_.detectors.size(), reach_m / gsd_m, radius_m / gsd_m);
    for (std::size_t i = 0; i < landmarks_.detectors.size(); ++i) {
      const MapDetector& detector = landmarks_.detectors[i];
      search.tolerance_px.push_back(landmark_tolerance_m(detector, gsd_m) / gsd_m);
      if (counts[i] == 0) continue;
      const long false_alarms = std::lround(detector.false_alarms_per_km2 * frame_km2);
      for (long alarm = 0; alarm < std::min(false_alarms, 64L); ++alarm) search.sightings.push_back({i, {0, 0}});
    }
    search.turns_and_scales = turns_and_scales(search, space(half_width_m / gsd_m));
    const std::size_t alike = p_unseen.size() - std::min(p_unseen.size(), independent_groups(search, pairs));
    view.p_fix = p_of_fix(search, p_unseen, alike, half_width_m / gsd_m);
    return view;
  }

 private:
  std::span<const GroundLandmark> between(double from_x_m, double to_x_m) const {
    const auto by_x = [](const GroundLandmark& one, double x_m) { return one.point_m.x() < x_m; };
    const auto first = std::lower_bound(on_grid_.begin(), on_grid_.end(), from_x_m, by_x);
    const auto last = std::lower_bound(first, on_grid_.end(), to_x_m, by_x);
    return {first, last};
  }

  std::vector<GroundLandmark> within(const Vector2d& middle_m, double reach_m) const {
    std::vector<GroundLandmark> found;
    for (const GroundLandmark& one : between(middle_m.x() - reach_m, middle_m.x() + reach_m)) {
      if ((one.point_m - middle_m).norm() <= reach_m) found.push_back(one);
    }
    return found;
  }

  SearchSpace space(double half_width_px) const {
    return {{0, 0}, half_width_px, options_.yaw_sigma_deg * kRadPerDeg, options_.height_sigma_fraction};
  }

  /// The chance that so many groups are seen that their evidence, less what the others say by not being seen, is
  /// enough. Of all, `alike` say nothing of their own, and these are taken to be among those that are seen.
  double p_of_fix(const LandmarkSearch& search, const std::map<std::size_t, double>& p_unseen, std::size_t alike,
                  double half_width_px) const {
    std::vector<double> p_seen{1};  // of 0, 1, 2 … groups: a Poisson binomial
    for (const auto& [group, p] : p_unseen) {
      p_seen.push_back(0);
      for (std::size_t k = p_seen.size() - 1; k > 0; --k) p_seen[k] = p_seen[k] * p + p_seen[k - 1] * (1 - p);
      p_seen[0] *= p;
    }
    double p_fix = 0;
    double p_so_few = 0;  // so many, or fewer, are seen: what the missing ones say
    for (std::size_t k = 0; k < p_seen.size(); ++k) {
      p_so_few += p_seen[k];
      const bool all_seen = k + 1 == p_seen.size();
      const double against = all_seen ? 0 : -std::log(std::clamp(p_so_few, 1e-30, 1.0));
      const double evidence = landmark_evidence(search, k - std::min(k, alike)) - against;
      if (false_fix_rate(evidence, half_width_px) <= options_.max_false_fix_rate) p_fix += p_seen[k];
    }
    return std::min(1.0, p_fix);
  }

  const Mission& mission_;
  const MapLandmarks& landmarks_;
  MatchOptions options_;
  std::vector<GroundLandmark> on_grid_;
};

std::string count_text(std::int64_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// "2", "2 and 4", "2, 4 and 5".
std::string listed(const std::vector<std::string>& words) {
  if (words.size() < 2) return join(words, "");
  return join({words.begin(), words.end() - 1}, ", ") + " and " + words.back();
}

std::string p_text(double p) {
  return format_fixed(std::floor(p * 100) / 100, 2);
}

}  // namespace

LandmarkNote landmark_note(const Mission& mission, const MapLandmarks& landmarks,
                           const std::vector<double>& p_fix_by_features) {
  const Prospects prospects(mission, landmarks);
  LandmarkNote note;
  note.legs.resize(p_fix_by_features.size());
  std::vector<std::vector<std::size_t>> shown;
  for (const GroundTile& tile : mission.ground.tiles) {
    FrameLandmarks view = prospects.view_of(tile);
    note.p_fix.push_back(view.p_fix);
    shown.push_back(std::move(view.shown));
  }
  std::vector<std::set<std::size_t>> of_leg(note.legs.size());
  for (const FlightSample& sample : mission.flight.samples) {
    const auto tile = tile_under(mission, sample);
    if (!tile || sample.leg < 0 || static_cast<std::size_t>(sample.leg) >= note.legs.size()) continue;
    LandmarkNote::Leg& leg = note.legs[static_cast<std::size_t>(sample.leg)];
    of_leg[static_cast<std::size_t>(sample.leg)].insert(shown[*tile].begin(), shown[*tile].end());
    if (note.p_fix[*tile] <= leg.p_fix) continue;
    leg.p_fix = note.p_fix[*tile];
    leg.distance_m = sample.distance_m;
  }
  for (std::size_t i = 0; i < note.legs.size(); ++i) {
    LandmarkNote::Leg& leg = note.legs[i];
    leg.landmarks = std::ssize(of_leg[i]);
    leg.gains = leg.p_fix >= kLeastLandmarkGain && !(p_fix_by_features[i] >= leg.p_fix);
  }
  for (const MapDetector& detector : landmarks.detectors) {
    note.classes.push_back({valid_utf8(detector.detector.class_name), 0, detector.p_detect,
                            detector.false_alarms_per_km2, detector.sigma_m});
  }
  for (const MapLandmark& landmark : landmarks.landmarks) ++note.classes[landmark.detector].landmarks;
  return note;
}

std::vector<std::string> landmark_sentences(const LandmarkNote& note) {
  std::int64_t count = 0;
  std::vector<std::string> names;
  for (const LandmarkNote::Class& one : note.classes) {
    count += one.landmarks;
    names.push_back(one.name);
  }
  std::vector<std::string> gaining;
  for (std::size_t i = 0; i < note.legs.size(); ++i) {
    if (note.legs[i].gains) gaining.push_back(std::to_string(i + 1) + " (P " + p_text(note.legs[i].p_fix) + ")");
  }
  std::string first = count_text(count, "landmark", "landmarks") + " of " +
                      count_text(std::ssize(note.classes), "class", "classes") + " (" + listed(names) + "): ";
  if (gaining.empty()) {
    first += "no leg gains a fix by landmarks alone.";
  } else if (gaining.size() == 1) {
    first += "leg " + gaining.front() + " gains a fix by landmarks alone.";
  } else {
    first += "legs " + listed(gaining) + " gain a fix by landmarks alone.";
  }
  return {first,
          "Modelled, not measured, and not counted in the verdict: a landmark that was found on the other date is seen "
          "on a frame that shows it whole with four fifths of P(detect), false alarms come as often as there, and the "
          "search is as wide as the limit."};
}

std::string landmark_html(const LandmarkNote& note) {
  std::string html =
      "<section aria-labelledby=\"landmarks-heading\">\n  <h2 id=\"landmarks-heading\">Fixes by landmarks</h2>\n";
  for (const std::string& sentence : landmark_sentences(note)) html += "  <p>" + html_escape(sentence) + "</p>\n";
  const auto table = [](const std::string& label, const std::string& heads) {
    return "  <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + label + "\"><table><thead><tr>" +
           heads + "</tr></thead><tbody>\n";
  };
  const auto head = [](const std::string& text) { return "<th scope=\"col\">" + text + "</th>"; };
  html += table("Table of landmarks by leg",
                head("Leg") + head("Landmarks shown") + head("P of a fix, at best") + head("At"));
  for (std::size_t i = 0; i < note.legs.size(); ++i) {
    const LandmarkNote::Leg& leg = note.legs[i];
    html += "<tr><th scope=\"row\">Leg " + std::to_string(i + 1) + "</th><td>" + std::to_string(leg.landmarks) +
            "</td><td>" + p_text(leg.p_fix) + (leg.gains ? ", a gain" : "") + "</td><td>" +
            (std::isnan(leg.distance_m) ? "–" : length_text(leg.distance_m)) + "</td></tr>\n";
  }
  html += "</tbody></table></div>\n  <details><summary>Classes</summary>\n" +
          table("Table of classes of landmarks", head("Class") + head("Landmarks") + head("P(detect)") +
                                                     head("False alarms per km²") + head("σ, each axis"));
  for (const LandmarkNote::Class& one : note.classes) {
    html += "<tr><th scope=\"row\">" + html_escape(one.name) + "</th><td>" + std::to_string(one.landmarks) +
            "</td><td>" + p_text(one.p_detect) + "</td><td>" + format_fixed(one.false_alarms_per_km2, 2) + "</td><td>" +
            format_fixed(one.sigma_m, 2) + " m</td></tr>\n";
  }
  return html + "</tbody></table></div></details>\n</section>\n";
}

Json landmark_json(const LandmarkNote& note) {
  const auto number = [](double value) { return variant_to_json(number_value(value)); };
  Json json = {{"classes", Json::array()}, {"legs", Json::array()}};
  for (const LandmarkNote::Class& one : note.classes) {
    json["classes"].push_back({{"class", one.name},
                               {"landmarks", one.landmarks},
                               {"p_detect", number(one.p_detect)},
                               {"false_alarms_per_km2", number(one.false_alarms_per_km2)},
                               {"sigma_m", number(one.sigma_m)}});
  }
  for (std::size_t i = 0; i < note.legs.size(); ++i) {
    const LandmarkNote::Leg& leg = note.legs[i];
    json["legs"].push_back({{"leg", i + 1},
                            {"landmarks", leg.landmarks},
                            {"p_fix", number(leg.p_fix)},
                            {"distance_m", number(leg.distance_m)},
                            {"gains", leg.gains}});
  }
  return json;
}

}  // namespace pilotage
