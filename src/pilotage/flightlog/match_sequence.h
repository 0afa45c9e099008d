#pragma once

#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/flightlog/frame_track.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/mapdb/parallel_reading.h"

namespace pilotage {

struct MatchedSequence {
  std::vector<FrameMatch>
      matches;  ///< In the order of the frames given; FrameMatch::frame has the prior that was used.
  SequenceSummary summary;
};

/// Matches the frames of a flight one after the other, in the order of their times (of equal times in the order given),
/// and carries a filter of the inertial position's error along (flightlog/drift_filter.h):
///
/// - A frame's prior is that of its row, less the error that the filter expects, where the filter knows better than the
///   row; the map's own error is added to its covariance, for the place is looked for on the map.
/// - A fix updates the filter unless it contradicts it (χ² of the innovation above the 99.9 % quantile).
/// - A candidate that is too weak by itself is a fix when it lies where the filter says and its
///   false_confirmation_rate() is low enough. Without a fix so far the last such candidate that shows no ground of this
///   frame starts a filter of its own, which says where to expect this one.
/// - After kTrackRefusals frames in a row without agreement the filter is given up, and rows count alone.
/// - When the next fix says kTrackJumps times in a row that the rows' errors did not drift from that filter's as the
///   model lets them (χ² above the same quantile), the rows are not those of one drifting system: all frames are
///   matched with their own priors, as by match_flight() (SequenceSummary::rows_jump).
///
/// Of MatchOptions::max_false_fix_rate each of the two ways to a fix gets one half. `model` is how the rows' inertial
/// positions drift, from the first frame on. Throws UsageError when a frame has no finite time_s or prior, and as
/// match_flight().
MatchedSequence match_sequence(const OpenMaps& open_maps, const std::vector<FlightFrame>& frames,
                               const MatchOptions& options, const InsErrorModel& model, const Progress& progress);

}  // namespace pilotage
