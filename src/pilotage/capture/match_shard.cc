#include "pilotage/capture/match_shard.h"

#include <set>

#include "pilotage/base/error.h"
#include "pilotage/capture/capture_frames.h"
#include "pilotage/capture/frame_pairs.h"
#include "pilotage/capture/frame_pictures.h"
#include "pilotage/capture/map_grid.h"
#include "pilotage/capture/match_folder.h"

namespace pilotage {

MatchedShard match_shard(const std::vector<std::string>& inputs, const CaptureOptions& options, const Shard& shard,
                         int threads, const Progress& progress) {
  if (options.matches.empty()) throw UsageError("matches is missing; give --matches FOLDER");
  check_map_options(options);
  MatchFolder folder(options.matches);
  CaptureFrames frames = read_capture_frames(inputs, options);
  const std::vector<std::array<int, 2>> all = neighbouring_frames(nadirs_en_m(frames, local_frame(frames)));
  const auto [begin, end] = shard_ranks(std::ssize(all), shard, "pair");
  std::vector<std::array<int, 2>> pairs(all.begin() + begin, all.begin() + end);
  std::set<int> numbers;
  for (const auto& pair : pairs) numbers.insert(pair.begin(), pair.end());

  std::vector<std::string> problems;
  const std::vector<FramePicture> pictures =
      read_pictures(frames, {numbers.begin(), numbers.end()}, &folder, threads, progress, problems);
  refuse_frames(problems, options.leave_out, frames);
  std::erase_if(pairs, [&](const auto& pair) {
    return pictures[static_cast<std::size_t>(pair[0])].small.empty() ||
           pictures[static_cast<std::size_t>(pair[1])].small.empty();
  });
  MatchedShard done;
  done.pairs = std::ssize(pairs);
  done.pairs_in = std::ssize(all);
  done.in_common = std::ssize(match_pairs(pairs, pictures, &folder, threads, progress));
  done.frames = std::ssize(readable(pictures));
  done.left_out = frames.left_out;
  done.warnings = frames.notes;
  if (!folder.warning().empty()) done.warnings.push_back(folder.warning());
  return done;
}

}  // namespace pilotage
