#pragma once

#include <cstddef>
#include <vector>

#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {

/// A simpler flight for the search under a budget: of each window only the best attempt counts (counted_attempts), and
/// how far a flight gets after a fix does not depend on those before.
///
/// How far a flight gets within the limit after a fix at each attempt. Node 0 is the start of the route, node k + 1 the
/// attempt k, the last node the end of the route.
struct FixChain {
  std::vector<std::size_t> last;  ///< Of each node but the end: the last node that is reached within the limit.
  std::size_t end() const { return last.size(); }
};

/// The error after a fix at an attempt is that of a flight whose other fixes come with `p_of_tile`; attempts that have
/// none there get one with a probability that changes nothing. The limit is looked at from attempt to attempt, and
/// where GNSS comes back; it holds the errors there and where it is lost again (hold_with_gnss).
FixChain make_fix_chain(const FlightPath& path, const std::vector<FixAttempt>& attempts,
                        const std::vector<double>& p_of_tile);

struct ChainValue {
  double value = 0;           ///< P(within the limit at the end) + 0.001 · (mean over the nodes).
  std::vector<double> slope;  ///< Of each node: d value / d P of a fix there.
};

/// `p[k]` is the P of a fix at node k; 0 at the first and the last node.
ChainValue chain_value(const FixChain& chain, const std::vector<double>& p);

}  // namespace pilotage
