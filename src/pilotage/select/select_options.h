#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"

namespace pilotage {

/// Which tiles become matching areas. By default all that can be matched.
struct SelectOptions {
  std::optional<std::string> budget;
  bool sparse = false;
  bool require = false;
  double min_peak_margin = 0.05;
  double fix_interval_s = 2.0;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("budget", self.budget, "Bytes that the map database may have, as 500000, 20MB or 20MiB.");
    fields.field("sparse", self.sparse, "The fewest matching areas such that no gap lets the error exceed its limit.");
    fields.field("require", self.require, "Exit with 3 when a gap lets the error exceed its limit.");
    fields.field("min_peak_margin", self.min_peak_margin,
                 "A tile can be matched when the peak of its degraded copies stands this far above every rival (NCC).",
                 Range{-2, 2});
    fields.field("fix_interval_s", self.fix_interval_s, "Time between two fixes over matchable ground.",
                 Range{0.01, 3600});
  }
};

}  // namespace pilotage
