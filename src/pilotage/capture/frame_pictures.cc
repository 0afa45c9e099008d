#include "pilotage/capture/frame_pictures.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/parallel.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {
namespace {

constexpr int kSmallSide_px = 400;

cv::Mat shrunk(const cv::Mat& picture) {
  const double scale = std::min(1.0, static_cast<double>(kSmallSide_px) / std::max(picture.cols, picture.rows));
  cv::Mat small;
  cv::resize(picture, small,
             {std::max(3, static_cast<int>(picture.cols * scale)), std::max(3, static_cast<int>(picture.rows * scale))},
             0, 0, cv::INTER_AREA);
  return small;
}

void check_size(const std::string& path, int width_px, int height_px, const Camera& camera) {
  if (width_px == camera.width_px && height_px == camera.height_px) return;
  throw DataError(path + ": has " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                  " pixels, the camera " + std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px));
}

FramePicture read_one(const std::string& path, const Camera& camera) {
  const cv::Mat picture =
      read_rgb8_picture(path, [&](int width_px, int height_px) { check_size(path, width_px, height_px, camera); });
  cv::Mat gray;
  cv::cvtColor(picture, gray, cv::COLOR_RGB2GRAY);
  return {"", picture.cols, picture.rows, find_frame_features(gray), shrunk(picture)};
}

/// What the folder has of a picture; else that picture's digest alone.
FramePicture kept_one(const std::string& path, const Camera& camera, MatchFolder& folder) {
  FramePicture one;
  one.digest = file_digest(path);
  if (std::optional<FramePicture> kept = folder.find_picture(one.digest)) {
    check_size(path, kept->width_px, kept->height_px, camera);
    return *std::move(kept);
  }
  return one;
}

}  // namespace

std::vector<FramePicture> read_pictures(const CaptureFrames& frames, const std::vector<int>& numbers,
                                        MatchFolder* folder, int threads, const Progress& progress,
                                        std::vector<std::string>& problems) {
  std::vector<FramePicture> pictures(frames.frames.size());
  std::vector<std::string> failures(numbers.size());
  std::mutex reporting;
  std::int64_t done = 0;
  const std::int64_t count = std::ssize(numbers);
  report_progress(progress, "finding features", 0, count);
  parallel_for(numbers.size(), threads, [&](std::size_t k, int) {
    const auto i = static_cast<std::size_t>(numbers[k]);
    const std::string& path = frames.frames[i].path;
    bool is_new = false;
    try {
      FramePicture one = folder != nullptr ? kept_one(path, frames.camera, *folder) : FramePicture{};
      is_new = one.small.empty();
      if (is_new) {
        std::string digest = std::move(one.digest);
        one = read_one(path, frames.camera);
        one.digest = std::move(digest);
      }
      pictures[i] = std::move(one);
    } catch (const DataError& error) {
      failures[k] = error.what();
    }
    // Outside: a folder that cannot be written to is no fault of the picture.
    if (is_new && failures[k].empty() && folder != nullptr) folder->keep_picture(pictures[i]);
    const std::lock_guard lock(reporting);
    report_progress(progress, "finding features", ++done, count);
  });
  for (const std::string& failure : failures) {
    if (!failure.empty()) problems.push_back(failure);
  }
  return pictures;
}

std::vector<int> all_numbers(std::size_t count) {
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

std::vector<int> readable(const std::vector<FramePicture>& pictures) {
  std::vector<int> numbers;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (!pictures[i].small.empty()) numbers.push_back(static_cast<int>(i));
  }
  return numbers;
}

std::vector<FrameFeatures> features_of(const std::vector<FramePicture>& pictures) {
  std::vector<FrameFeatures> features;
  features.reserve(pictures.size());
  for (const FramePicture& picture : pictures) features.push_back(picture.features);
  return features;
}

}  // namespace pilotage
