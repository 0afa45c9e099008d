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

cv::Mat read_picture(const std::string& path, const Camera& camera) {
  return read_rgb8_picture(path, [&](int width_px, int height_px) {
    if (width_px == camera.width_px && height_px == camera.height_px) return;
    throw DataError(path + ": has " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                    " pixels, the camera " + std::to_string(camera.width_px) + " x " +
                    std::to_string(camera.height_px));
  });
}

FrameFeatures features_of(const cv::Mat& picture) {
  cv::Mat gray;
  cv::cvtColor(picture, gray, cv::COLOR_RGB2GRAY);
  return find_frame_features(gray);
}

/// Of its size and pixels, whatever file they are from.
std::string digest_of(const cv::Mat& picture) {
  const cv::Mat whole = picture.isContinuous() ? picture : picture.clone();
  return bytes_digest(std::to_string(whole.cols) + " x " + std::to_string(whole.rows) + " " +
                      bytes_digest({reinterpret_cast<const char*>(whole.data), whole.total() * whole.elemSize()}));
}

FrameFeatures kept_features_of(const cv::Mat& picture, MatchFolder& folder) {
  const std::string digest = digest_of(picture);
  if (std::optional<FrameFeatures> kept = folder.find_features(digest)) return *std::move(kept);
  FrameFeatures features = features_of(picture);
  folder.keep_features(digest, features);
  return features;
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
    cv::Mat picture;
    try {
      picture = read_picture(frames.frames[i].path, frames.camera);
    } catch (const DataError& error) {
      failures[k] = error.what();
    }
    if (!picture.empty()) {
      pictures[i].features = folder != nullptr ? kept_features_of(picture, *folder) : features_of(picture);
      pictures[i].small = shrunk(picture);
    }
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
