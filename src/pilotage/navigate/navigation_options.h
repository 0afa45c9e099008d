#pragma once

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What the navigation filter is told beside the inertial system's figures (ins/ins_options.h). Errors are one standard
/// deviation; the slow ones are first-order Gauss-Markov processes.
struct NavigationOptions {
  double map_sigma_m = 1;
  double map_correlation_m = 300;
  double barometer_sigma_m = 10;
  double barometer_correlation_s = 1800;
  double barometer_noise_m = 0.5;
  int refusals_to_reset = 4;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("map_sigma_m", self.map_sigma_m, "Standard deviation, along each axis, of the map's own georeference.",
                 Range{0, 100});
    fields.field("map_correlation_m", self.map_correlation_m,
                 "Way over which the error of the map's georeference changes: about a tile.", Range{1, 1e6});
    fields.field("barometer_sigma_m", self.barometer_sigma_m, "Slow error of the barometric height.",
                 Range{0.01, 1000});
    fields.field("barometer_correlation_s", self.barometer_correlation_s,
                 "Time over which the slow error of the barometric height changes.", Range{1, 1e6});
    fields.field("barometer_noise_m", self.barometer_noise_m, "Noise of one reading of the barometric height.",
                 Range{0.01, 100});
    fields.field("refusals_to_reset", self.refusals_to_reset,
                 "So many fixes in a row that contradict the filter, but not each other, are believed.", Range{2, 100});
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
