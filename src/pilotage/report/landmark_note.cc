#include "pilotage/report/landmark_note.h"

#include <cmath>
#include <set>

#include "pilotage/base/markup.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/base/wording.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/report/landmark_prospects.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/tile_fields.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

LandmarkNote landmark_note(const Mission& mission, const MapLandmarks& landmarks,
                           const std::vector<double>& p_fix_by_features) {
  const std::vector<LandmarkProspect> prospects =
      landmark_prospects(mission.ground, landmarks, mission.flight.camera, mission.flight.max_error_m);
  LandmarkNote note;
  note.legs.resize(p_fix_by_features.size());
  for (const LandmarkProspect& prospect : prospects) note.p_fix.push_back(prospect.p_fix);
  std::vector<std::set<std::size_t>> of_leg(note.legs.size());
  for (const FlightSample& sample : mission.flight.samples) {
    const auto tile = tile_under(mission, sample);
    if (!tile || sample.leg < 0 || static_cast<std::size_t>(sample.leg) >= note.legs.size()) continue;
    LandmarkNote::Leg& leg = note.legs[static_cast<std::size_t>(sample.leg)];
    of_leg[static_cast<std::size_t>(sample.leg)].insert(prospects[*tile].shown.begin(), prospects[*tile].shown.end());
    if (note.p_fix[*tile] <= leg.p_fix) continue;
    leg.p_fix = note.p_fix[*tile];
    leg.distance_m = sample.distance_m;
  }
  for (std::size_t i = 0; i < note.legs.size(); ++i) {
    LandmarkNote::Leg& leg = note.legs[i];
    leg.landmarks = std::ssize(of_leg[i]);
    leg.gains = leg.p_fix >= kLeastLandmarkGain && leg.p_fix > p_fix_by_features[i];
  }
  note.classes = landmark_classes(landmarks);
  note.assumes = landmark_assumption("the verdict", "as the limit allows",
                                     unresolved_classes(mission.ground, landmarks, mission.flight.camera));
  return note;
}

std::vector<std::string> landmark_sentences(const LandmarkNote& note) {
  std::vector<std::string> gaining;
  for (std::size_t i = 0; i < note.legs.size(); ++i) {
    if (note.legs[i].gains)
      gaining.push_back(std::to_string(i + 1) + " (P " + landmark_p_text(note.legs[i].p_fix) + ")");
  }
  std::string first = landmarks_phrase(note.classes) + ": ";
  if (gaining.empty()) {
    first += "no leg gains a fix by landmarks alone.";
  } else if (gaining.size() == 1) {
    first += "leg " + gaining.front() + " gains a fix by landmarks alone.";
  } else {
    first += "legs " + listed(gaining) + " gain a fix by landmarks alone.";
  }
  return {first, note.assumes};
}

std::string landmark_html(const LandmarkNote& note) {
  std::string html =
      "<section aria-labelledby=\"landmarks-heading\">\n  <h2 id=\"landmarks-heading\">Fixes by landmarks</h2>\n";
  for (const std::string& sentence : landmark_sentences(note)) html += "  <p>" + html_escape(sentence) + "</p>\n";
  std::string rows;
  for (std::size_t i = 0; i < note.legs.size(); ++i) {
    const LandmarkNote::Leg& leg = note.legs[i];
    rows += "<tr>" + heading_html("Leg " + std::to_string(i + 1)) +
            cell_html("Landmarks shown", std::to_string(leg.landmarks)) +
            cell_html("P of a fix, at best", landmark_p_text(leg.p_fix) + (leg.gains ? ", a gain" : "")) +
            cell_html("At", std::isnan(leg.distance_m) ? "–" : length_text(leg.distance_m)) + "</tr>\n";
  }
  return html + table_html("Table of landmarks by leg", {"Leg", "Landmarks shown", "P of a fix, at best", "At"}, rows) +
         landmark_classes_html(note.classes) + "</section>\n";
}

Json landmark_json(const LandmarkNote& note) {
  const auto number = [](double value) { return variant_to_json(number_value(value)); };
  Json json = {{"classes", landmark_classes_json(note.classes)}, {"legs", Json::array()}, {"assumes", note.assumes}};
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
