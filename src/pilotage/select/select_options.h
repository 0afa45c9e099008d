#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Which tiles become matching areas. By default all that can be matched.
struct SelectOptions {
  std::optional<std::string> budget;
  bool sparse = false;
  bool require = false;
  double min_peak_margin = 0.05;
  double fix_interval_s = 2.0;
  double min_p_correct_fix = 0.2;
  std::optional<double> fix_decorrelation_m;
  double max_false_fix_rate = 0.001;
  double min_route_probability = 0.9;
  bool advise = false;
  double min_leg_probability = 0.95;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("budget", self.budget, "Bytes that the map database may have, as 500000, 20MB or 20MiB.");
    fields.field("sparse", self.sparse, "The fewest matching areas such that no gap lets the error exceed its limit.");
    fields.field("require", self.require,
                 "Exit with 3 when a gap lets the error exceed its limit or the route's probability is too small.");
    fields.field("min_peak_margin", self.min_peak_margin,
                 "A tile can be matched when the peak of its degraded copies stands this far above every rival (NCC).",
                 Range{-2, 2});
    fields.field("fix_interval_s", self.fix_interval_s, "Time between two fixes over matchable ground.",
                 Range{0.01, 3600});
    fields.field(
        "min_p_correct_fix", self.min_p_correct_fix,
        "A tile whose probability of a correct fix is known can be matched from here on; the margin is then not "
        "asked.",
        Range{0, 1});
    fields.field(
        "fix_decorrelation_m", self.fix_decorrelation_m,
        "Way along the track over which tries to fix succeed or fail together; the width of a tile if not given.",
        Range{1, 1e6});
    fields.field("max_false_fix_rate", self.max_false_fix_rate,
                 "Rate of false fixes that the matcher will be asked to keep (match --max-false-fix-rate).",
                 Range{1e-6, 0.5});
    fields.field("min_route_probability", self.min_route_probability,
                 "Least probability that the error stays within its limit over the whole route.", Range{0, 1});
    fields.field("advise", self.advise, "Look for a parallel line for each leg whose probability is too small.");
    fields.field("min_leg_probability", self.min_leg_probability,
                 "Least probability that the error stays within its limit on a leg, for --advise.", Range{0, 1});
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
