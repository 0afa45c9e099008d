#pragma once

#include <vector>

#include "pilotage/capture/block.h"

namespace pilotage {

/// A block before its adjustment.
struct BlockStart {
  std::vector<FramePose> poses;
  double agl_m = 0;                 ///< Median height of the cameras over the ground, as the pictures' scale has it.
  std::vector<double> turned_deg;   ///< Heading that the pictures show, less the measured one; of frames without: 0.
  std::vector<double> displaced_m;  ///< How far each frame lies from its measured place, for its pictures.
};

/// Heading, height over the ground and place of every frame from matches alone, over ground that is taken for flat and
/// with tilts as measured (else as the camera is mounted). With ground points as complex numbers (east + i north), a
/// pixel is at C + z·u, u its place for a camera 1 m up with the assumed heading, and z = height · turn of the heading:
/// each match gives one equation linear in z and C of two frames. They are solved with the measured places as
/// priors of Cauchy's weights; matches count in full at first, so that a frame with a wrong place moves, and by
/// Cauchy's weights later, so that false ones do not bend the block. Throws DataError when there is no pair or no
/// height comes out.
BlockStart start_block(const Block& block);

}  // namespace pilotage
