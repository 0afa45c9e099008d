#include "pilotage/report/landmark_classes.h"

#include <cmath>

#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/base/wording.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/match/match.h"
#include "pilotage/report/landmark_prospects.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/tile_fields.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::vector<LandmarkClass> landmark_classes(const MapLandmarks& landmarks) {
  std::vector<LandmarkClass> classes;
  for (const MapDetector& detector : landmarks.detectors) {
    classes.push_back({valid_utf8(detector.detector.class_name), 0, detector.p_detect, detector.false_alarms_per_km2,
                       detector.sigma_m});
  }
  for (const MapLandmark& landmark : landmarks.landmarks) ++classes[landmark.detector].landmarks;
  return classes;
}

std::string landmarks_phrase(const std::vector<LandmarkClass>& classes) {
  std::int64_t count = 0;
  std::vector<std::string> names;
  for (const LandmarkClass& one : classes) {
    count += one.landmarks;
    names.push_back(one.name);
  }
  return count_text(count, "landmark", "landmarks") + " of " + count_text(std::ssize(classes), "class", "classes") +
         " (" + listed(names) + ")";
}

std::string landmark_assumption(const std::string& answer, const std::string& place,
                                const std::vector<std::string>& unresolved) {
  const MatchOptions options;
  std::string text =
      "Modelled, not measured, and not counted in " + answer +
      ": a landmark that was found on the other date is seen on a frame that shows it whole with four fifths of "
      "P(detect), false alarms come as often as there; in level flight a frame's place is known " +
      place + ", its heading with a σ of " + format_number(options.yaw_sigma_deg) + "°, its tilt of " +
      format_number(options.attitude_sigma_deg) + "° and its height of " +
      format_number(100 * options.height_sigma_fraction) +
      " %. Not modelled: another place with landmarks in the same array, and relief.";
  if (!unresolved.empty()) {
    text += " Not counted: " + listed(unresolved) + ", for the camera's pixels are more than " +
            format_number(kCoarsestOfDetector) + " times as wide as those of the detector, which was not tried.";
  }
  return text;
}

std::string landmark_p_text(double p) {
  if (p > 0 && p < 0.01) return "below 0.01";
  return format_fixed(std::floor(p * 100 + 1e-9) / 100, 2);
}

std::string landmark_classes_html(const std::vector<LandmarkClass>& classes) {
  std::string rows;
  for (const LandmarkClass& one : classes) {
    rows += "<tr>" + heading_html(one.name) + cell_html("Landmarks", std::to_string(one.landmarks)) +
            cell_html("P(detect)", landmark_p_text(one.p_detect)) +
            cell_html("False alarms per km²", format_fixed(one.false_alarms_per_km2, 2)) +
            cell_html("σ, each axis", format_fixed(one.sigma_m, 2) + " m") + "</tr>\n";
  }
  return "  <details><summary>Classes</summary>\n" +
         table_html("Table of classes of landmarks",
                    {"Class", "Landmarks", "P(detect)", "False alarms per km²", "σ, each axis"}, rows) +
         "</details>\n";
}

Json landmark_classes_json(const std::vector<LandmarkClass>& classes) {
  const auto number = [](double value) { return variant_to_json(number_value(value)); };
  Json json = Json::array();
  for (const LandmarkClass& one : classes) {
    json.push_back({{"class", one.name},
                    {"landmarks", one.landmarks},
                    {"p_detect", number(one.p_detect)},
                    {"false_alarms_per_km2", number(one.false_alarms_per_km2)},
                    {"sigma_m", number(one.sigma_m)}});
  }
  return json;
}

}  // namespace pilotage
