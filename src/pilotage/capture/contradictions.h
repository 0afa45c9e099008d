#pragma once

#include <string>
#include <vector>

#include "pilotage/capture/adjust_block.h"
#include "pilotage/capture/capture_frames.h"

namespace pilotage {

/// What the pictures contradict of where frames say they were.
struct Contradictions {
  std::vector<bool> position;  ///< Of each frame: its position or height.
  std::vector<std::string> problems;
  std::vector<std::string> warnings;  ///< Headings, which are not needed.
};

/// Positions and heights more than five standard deviations (or five times what is usual in the block) from where the
/// adjustment put them; headings that differ from what the matches show by more than 30° beyond what is usual.
Contradictions find_contradictions(const CaptureFrames& frames, const Block& block, const BlockStart& start,
                                   const AdjustedBlock& adjusted);

/// DataError naming the control points that lie more than five standard deviations from where a mark of theirs puts
/// them.
void refuse_control_contradictions(const CaptureFrames& frames, const Block& block, const AdjustedBlock& adjusted,
                                   double gsd_m);

/// Frames that see at least ten adjusted points together, as pairs without matches: what holds the block together.
std::vector<FramePair> shared_points(const AdjustedBlock& adjusted);

}  // namespace pilotage
