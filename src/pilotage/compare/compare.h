#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/camera/camera.h"
#include "pilotage/compare/compare_options.h"
#include "pilotage/compare/descriptor_method.h"
#include "pilotage/mission/frame_table.h"

namespace pilotage {

/// The paper counts how many of so many best matches are right.
inline constexpr int kBestMatches = 10;

/// What one method made of one frame. Times of one thread.
struct MethodOutcome {
  int frame_features = 0;
  int reference_features = 0;
  double detect_ms = 0;     ///< The frame's features,
  double describe_ms = 0;   ///< and their descriptors.
  double reference_ms = 0;  ///< Both for the reference, which a map holds ready.
  double match_ms = 0;
  int matches = 0;           ///< One for each feature of the frame, if the reference has any.
  int matches_agreeing = 0;  ///< Those within tolerance_m of the truth.
  int best = 0;              ///< The kBestMatches of smallest distance, or fewer.
  int best_agreeing = 0;
  int candidates = 0;                                         ///< Matches that passed the ratio test.
  int inliers = 0;                                            ///< Those that agree with the transform.
  double scale = std::numeric_limits<double>::quiet_NaN();    ///< Of the transform over the expected one.
  double error_m = std::numeric_limits<double>::quiet_NaN();  ///< Of the transform's position, accepted or not.
  bool accepted = false;
  bool correct = false;  ///< Accepted, and within correct_within_m.

  double total_ms() const { return detect_ms + describe_ms + match_ms; }
};

struct FrameComparison {
  std::string file;
  std::string problem;           ///< Why there was nothing to match; "" when there was.
  bool shows_reference = false;  ///< The truth lies in the search window, on imagery. Other frames have no correct fix.
  std::vector<MethodOutcome> methods;  ///< In the order of Comparison::methods.
};

struct MatchPicture {
  DescriptorMethod method = DescriptorMethod::kOrb;
  cv::Mat bgr;
};

struct Comparison {
  std::vector<DescriptorMethod> methods;
  std::vector<FrameComparison> frames;
  std::vector<MatchPicture> pictures;  ///< One for each method, of the frame that was asked for.
  double gsd_m = 0;                    ///< Of the reference as it was matched.
  std::vector<std::string> warnings;
};

/// The pixels of a frame: 8-bit gray.
using FrameReader = std::function<cv::Mat(const FrameRecord& record)>;

/// Takes every frame through every method: features of the frame and of the reference around its prior (`reference`:
/// GDAL datasets), brute-force matching, one robust transform, one rule of acceptance; then the truth judges matches
/// and fix. A fix is accepted when at least min_inliers agree with the transform, its scale is within max_scale_error
/// of that of height and camera, and its position lies in the prior's window. Frames are done one after the other on
/// one thread, OpenCV held to one, so that times can be compared; a first pass over the first frame is not counted,
/// because it pays for loading code. All but times is the same for the same seed. Throws UsageError when there is no
/// method or one twice, or picture_frame is above the number of frames; DataError as make_compared_pair and
/// inspect_imagery, or when a frame's size is not the camera's; Interrupted.
Comparison compare(const std::vector<std::string>& reference, const std::vector<FrameRecord>& frames,
                   const FrameReader& read_frame, const Camera& camera, const CompareOptions& options,
                   std::uint64_t seed = 1, const Progress& progress = {});

}  // namespace pilotage
