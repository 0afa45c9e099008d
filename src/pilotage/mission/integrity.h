#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/statistics.h"

#pragma GCC visibility push(default)

namespace pilotage {

class JsonObject;

/// The error exceeds the bound that integrity is judged by with at most this probability, if the covariance is honest.
inline constexpr double kBeyondBound = 1e-3;

/// The bound in largest standard deviations of a horizontal position: √(−2 ln 0.001) = 3.72. Of errors that are as
/// large on both axes it is exceeded with kBeyondBound, of others less often.
double integrity_sigma_multiple();

/// How often navigation says "all clear" while it is wrong.
struct Integrity {
  double limit_m = 0;
  double looked = 0;        ///< What was looked at: seconds of simulated flights without GNSS, or frames of flown ones.
  double clear_share = 0;   ///< Of that: the bound lies within the limit. NaN of nothing.
  double misled_share = 0;  ///< Of that: and yet the error does not. NaN of nothing.
  Interval misled;          ///< Its 95 % interval; [0, 1] of nothing.
  std::int64_t stretches = 0;  ///< Stretches between fixes, as many of one length as say as much as those that were.
};

/// Adds up what integrity is judged by. Errors between two fixes lean alike and those of different stretches do not, so
/// the interval is that of Clopper and Pearson for as many trials as there are stretches: (Σ w)² / Σ w² of their
/// weights (L. Kish, "Survey Sampling", 1965, for clusters whose members are all alike).
class IntegrityCount {
 public:
  /// A look that stands for `weight` of the flight: the largest standard deviation that is believed, and the error.
  void look(double weight, double sigma_m, double error_m, double limit_m);
  /// A fix was taken, or the flight ends: what follows errs on its own.
  void end_stretch();
  void add(const IntegrityCount& other);
  Integrity result(double limit_m) const;

 private:
  double looked_ = 0;
  double clear_ = 0;
  double misled_ = 0;
  double stretch_ = 0;
  double squares_ = 0;
};

/// As simulation.json and replay.json have it.
nlohmann::ordered_json integrity_to_json(const Integrity& integrity);
Integrity integrity_from_json(JsonObject json);

/// "all clear (bound of 3.72 σ within 60 m) for 0.962 of the flight, and wrong for 0.0004 [0.0001, 0.0012] of it, by
/// 930 stretches between fixes"
std::string integrity_text(const Integrity& integrity);

}  // namespace pilotage

#pragma GCC visibility pop
