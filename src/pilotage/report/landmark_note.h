#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/mission/mission.h"
#include "pilotage/report/landmark_classes.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What landmarks promise along the route. Modelled, not measured; the verdict does not count it.
struct LandmarkNote {
  struct Leg {
    std::int64_t landmarks = 0;  ///< Found on the other date, and a frame from its line shows them whole.
    double p_fix = 0;            ///< P of a fix by landmarks alone, where it is largest.
    double distance_m = std::numeric_limits<double>::quiet_NaN();  ///< Where, along the route; NaN where it is 0.
    bool gains = false;  ///< p_fix is kLeastLandmarkGain at least, and more than P of a fix by features.
  };
  std::vector<LandmarkClass> classes;
  std::vector<double> p_fix;  ///< Of a frame about the middle of each tile of the ground, by landmarks alone.
  std::vector<Leg> legs;      ///< Of the route, in its order.
  std::string assumes;        ///< landmark_assumption().
};

/// landmark_prospects() of the mission's tiles, stored or not, searched as wide as its limit, and of its legs.
/// `p_fix_by_features` of each leg, NaN where not known: nothing is gained over that. Landmarks off the planned ground
/// do not count.
LandmarkNote landmark_note(const Mission& mission, const MapLandmarks& landmarks,
                           const std::vector<double>& p_fix_by_features);

/// "76 landmarks of 3 classes (ring, roundabout and tank): legs 2 and 4 gain a fix by landmarks …", and what is
/// assumed.
std::vector<std::string> landmark_sentences(const LandmarkNote& note);

/// The section of the page.
std::string landmark_html(const LandmarkNote& note);

/// As it stands in report.json.
nlohmann::ordered_json landmark_json(const LandmarkNote& note);

}  // namespace pilotage

#pragma GCC visibility pop
