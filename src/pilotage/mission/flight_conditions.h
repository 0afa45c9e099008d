#pragma once

#include <optional>

#include "pilotage/base/options.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/ins/ins_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Way over which the error of a map's georeference changes, where nobody says.
inline constexpr double kMapCorrelation_m = 300;
/// Of a map that is off everywhere alike: it hardly changes over any flight.
inline constexpr double kCommonMapCorrelation_m = 1e6;

/// What a flight meets beside the errors of its inertial system: what its chances are averaged over, and what
/// `simulate` draws. Errors are one standard deviation of one axis.
struct FlightConditions {
  double wind_sigma_mps = 3;
  std::optional<double> map_sigma_m;
  std::optional<double> map_correlation_m;
  double dropped_frames = 0.01;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field(
        "wind_sigma_mps", self.wind_sigma_mps,
        "Wind on the day of the flight, of which nothing else is known: steady, each axis; the planned speed is "
        "held against the air. 0: the planned speed is that over ground.",
        Range{0, 100});
    fields.field(
        "map_sigma_m", self.map_sigma_m,
        "Error of the map's own georeference, each axis; if not given, what the imagery says of itself (capture writes "
        "it), else 1.",
        Range{0, 100});
    fields.field("map_correlation_m", self.map_correlation_m,
                 "Way over which the error of the map's georeference changes; if not given, 300, and 1,000,000 where "
                 "the imagery says how far it is off: it is then the same everywhere.",
                 Range{1, 1e6});
    fields.field("dropped_frames", self.dropped_frames, "Share of the tries to fix to which no frame comes.",
                 Range{0, 1});
  }
};

/// Plans have both of the map's; else they are kUnknownMapSigma_m and kMapCorrelation_m.
/// make_ins_error_model() with the error of the map.
InsErrorModel make_error_model(const InsOptions& ins, const FlightConditions& conditions);

}  // namespace pilotage

#pragma GCC visibility pop
