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
  std::optional<double> max_error_m;
  double min_peak_margin = 0.05;
  double min_valid_fraction = 0.7;
  double fix_interval_s = 2.0;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("budget", self.budget, "Bytes that the map database may have, as 500000, 20MB or 20MiB.");
    fields.field("sparse", self.sparse, "The fewest matching areas such that no gap lets the error exceed its limit.");
    fields.field("require", self.require, "Exit with 3 when a gap lets the error exceed its limit.");
    fields.field("max_error_m", self.max_error_m,
                 "Limit of the position error (k sigma); as in the tile plan if not given.", Range{1, 10000});
    fields.field("min_peak_margin", self.min_peak_margin,
                 "A tile can be matched when the peak of its degraded copies stands this far above every rival (NCC).",
                 Range{-2, 2});
    fields.field("min_valid_fraction", self.min_valid_fraction, "Share of a tile that imagery must cover.",
                 Range{0, 1});
    fields.field("fix_interval_s", self.fix_interval_s, "Time between two fixes over matchable ground.",
                 Range{0.01, 3600});
  }
};

}  // namespace pilotage
