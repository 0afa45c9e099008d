#pragma once

#include <cstdint>
#include <optional>

#include "pilotage/base/options.h"

namespace pilotage {

/// How it is decided whether a try to fix succeeds.
enum class FixesFrom { kDrawn, kRendered, kAirsim, kNone };
inline EnumNames<FixesFrom> enum_names(FixesFrom) {
  return {{FixesFrom::kDrawn, "drawn"},
          {FixesFrom::kRendered, "rendered"},
          {FixesFrom::kAirsim, "airsim"},
          {FixesFrom::kNone, "none"}};
}

/// What is drawn of each flight beside the inertial system's errors (docs/methods/simulate.md). Errors are one standard
/// deviation of one axis.
struct SimulateOptions {
  std::int64_t flights = 1000;
  FixesFrom fixes = FixesFrom::kDrawn;
  std::optional<double> lost_from_km;
  std::optional<double> lost_every_km;
  std::optional<double> map_sigma_m;
  std::optional<double> map_correlation_m;
  std::optional<double> wind_sigma_mps;
  std::optional<double> dropped_frames;
  std::optional<double> false_fix_rate;
  std::optional<double> require_simulated;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("flights", self.flights, "How many flights are flown; 20 are a beginning with rendered fixes.",
                 Range{1, 1000000});
    fields.field(
        "fixes", self.fixes,
        "Whether a try to fix succeeds: drawn by the P of the tile that is really below the aircraft; rendered: "
        "what the matcher answers to a frame of the ground there; airsim: the same, by frames of a simulator "
        "(--airsim); none: never.");
    fields.field("lost_from_km", self.lost_from_km,
                 "Where along the route GNSS is lost for good, instead of where the plan says.", Range{0, 100000});
    fields.field("lost_every_km", self.lost_every_km,
                 "Lose GNSS for good at each of these distances in turn; the result is that of the worst place.",
                 Range{0.001, 100000});
    fields.field("map_sigma_m", self.map_sigma_m, "Error of the map's own georeference; the plan's if not given.",
                 Range{0, 100});
    fields.field("map_correlation_m", self.map_correlation_m,
                 "Way over which the error of the map's georeference changes; the plan's if not given.", Range{1, 1e6});
    fields.field("wind_sigma_mps", self.wind_sigma_mps,
                 "Wind, steady over a flight; the planned speed is held against the air. The plan's if not given.",
                 Range{0, 100});
    fields.field("dropped_frames", self.dropped_frames,
                 "Share of the tries to which no frame comes; the plan's if not given.", Range{0, 1});
    fields.field("false_fix_rate", self.false_fix_rate,
                 "Share of false fixes among tries that find no right one; the selection's if not given.",
                 Range{0, 0.5});
    fields.field(
        "require_simulated", self.require_simulated,
        "Exit with 3 when the lower end of the interval of the share of flights within the limit is below this.",
        Range{0, 1});
  }
};

}  // namespace pilotage
