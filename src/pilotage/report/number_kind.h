#pragma once

#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

/// What a number on the page rests on.
enum class NumberKind {
  kMeasured,   ///< On the imagery, or on flights.
  kSimulated,  ///< By flights or frames that were computed with drawn errors.
  kModelled,   ///< By a formula: the inertial error model, or a fitted P.
  kStated,     ///< By the mission or the plan: nothing was found out.
};

/// A word behind a heading or a number, with what it means as its title; "" for kStated.
std::string kind_mark(NumberKind kind);

}  // namespace pilotage

#pragma GCC visibility pop
