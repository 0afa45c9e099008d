#pragma once

#include <string>
#include <vector>

#include "pilotage/capture/capture.h"
#include "pilotage/capture/capture_frames.h"
#include "pilotage/capture/contradictions.h"
#include "pilotage/capture/map_grid.h"

namespace pilotage {

// An adjusted block in the words and numbers of a CaptureResult.

/// CaptureResult::frames and position_rms_m, without the positions that are contradicted.
void describe_frames(const CaptureFrames& frames, const Block& block, const AdjustedBlock& adjusted,
                     const GroundSurface& ground, const EastNorthBounds& bounds, const LocalFrame& local,
                     const Contradictions& contradictions, CaptureResult& result);

/// What holds for the block as a whole, and its warnings.
void describe_block(const CaptureFrames& frames, const Block& block, const AdjustedBlock& adjusted,
                    CaptureResult& result);

/// What follows from CaptureResult::check_points, of `given` ones, and its warnings.
void describe_checks(std::size_t given, CaptureResult& result);

/// Whether the map lies farther from the other one than before it was tied to it, by more than can be measured.
bool is_farther(const MapAlignment& alignment);

/// The warnings of CaptureResult::alignment, which it must have.
void describe_alignment(CaptureResult& result);

/// What is taken for granted. `elevation`: how the heights of the model are counted, or "" without one.
std::vector<std::string> assumptions_of(const CaptureFrames& frames, const Block& block, const std::string& elevation,
                                        const CaptureResult& result, const RegistrationOptions& registration);

}  // namespace pilotage
