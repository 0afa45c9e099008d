#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "pilotage/base/output_file.h"
#include "pilotage/matchability/matchability_model.h"

namespace pilotage::testing {

/// The file of a model for a place where fixes come often and a second date has been judged, as `calibrate --adapt`
/// writes it: on one date alone hardly any small tile has a P that planners would go with.
inline std::string model_of_known_level(const std::filesystem::path& folder) {
  MatchabilityModel model = default_matchability_model();
  for (MatcherModel& matcher : model.matchers) {
    matcher.level.mean = 3;
    matcher.level.sigma = 0.3;
    matcher.level.tiles = 400;
  }
  const std::filesystem::path path = folder / "known_level.json";
  write_file(path, matchability_model_to_json(model).dump(1), true);
  return path.string();
}

}  // namespace pilotage::testing
