#pragma once

#include <string>

#include "pilotage/base/options.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/registration/registration_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How a map is held against another one.
struct AuditOptions {
  double max_shift_m = 3;
  double min_compared = 0.5;
  std::string crs;
  ImageryOptions imagery;
  RegistrationOptions registration;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("max_shift_m", self.max_shift_m,
                 "The map may lie so far from the other one: 95 % of the ground that could be compared.",
                 Range{0.01, 1000});
    fields.field("min_compared", self.min_compared,
                 "Share of the ground that both show that must be compared; with less there is no verdict.",
                 Range{0, 1});
    fields.field("crs", self.crs, "CRS in which shifts are measured, projected in metres; chosen if not given.");
    ImageryOptions::describe(self.imagery, fields);
    fields.group("registration", self.registration, "How the other map is brought onto it.");
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
