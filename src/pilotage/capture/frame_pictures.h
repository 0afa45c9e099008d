#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/capture/capture_frames.h"
#include "pilotage/capture/frame_features.h"
#include "pilotage/capture/match_folder.h"

namespace pilotage {

/// The pictures of the frames at the ascending `numbers`, on up to `threads` threads; the others stay empty. Features
/// that `folder` has are taken from there, and those that it has not are kept there; null: nothing is kept. A picture
/// that cannot be read, or has not the camera's size, stays empty, and `problems` says why, "path: why". Throws
/// DataError when the folder cannot be written to; Interrupted.
std::vector<FramePicture> read_pictures(const CaptureFrames& frames, const std::vector<int>& numbers,
                                        MatchFolder* folder, int threads, const Progress& progress,
                                        std::vector<std::string>& problems);

/// 0 … count - 1.
std::vector<int> all_numbers(std::size_t count);

/// The frames whose pictures could be read.
std::vector<int> readable(const std::vector<FramePicture>& pictures);

/// Of each picture.
std::vector<FrameFeatures> features_of(const std::vector<FramePicture>& pictures);

}  // namespace pilotage
