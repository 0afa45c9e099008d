#include "pilotage/vision/feature_descriptor.h"

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/vision/brief_pattern.h"

namespace pilotage {
namespace {

/// Half the width of the centroid's disc in each row from its middle.
std::array<int, kCentroidRadiusPx + 1> disc_half_widths() {
  std::array<int, kCentroidRadiusPx + 1> widths{};
  for (int row = 0; row <= kCentroidRadiusPx; ++row) {
    widths[static_cast<std::size_t>(row)] =
        static_cast<int>(std::sqrt(kCentroidRadiusPx * kCentroidRadiusPx - row * row));
  }
  return widths;
}

/// cv::ORB's pattern at given places and angles.
std::vector<std::uint8_t> describe_by_orb(const cv::Mat& gray, const std::vector<Corner>& corners,
                                          const std::vector<float>& angles_deg) {
  constexpr std::size_t kBytes = 32;
  std::vector<cv::KeyPoint> keypoints;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    keypoints.emplace_back(static_cast<float>(corners[i].x), static_cast<float>(corners[i].y), 31.0F, angles_deg[i],
                           corners[i].response, 0, static_cast<int>(i));
  }
  // One level; an edge threshold of 1 keeps every corner, whose patch is inside anyway.
  const auto orb = cv::ORB::create(static_cast<int>(corners.size()), 1.2F, 1, 1);
  cv::Mat rows;
  orb->compute(gray, keypoints, rows);
  std::vector<std::uint8_t> descriptors(corners.size() * kBytes);
  if (keypoints.size() != corners.size()) throw std::logic_error("cv::ORB left out a key point");
  for (std::size_t row = 0; row < keypoints.size(); ++row) {
    std::memcpy(descriptors.data() + static_cast<std::size_t>(keypoints[row].class_id) * kBytes,
                rows.ptr<std::uint8_t>(static_cast<int>(row)), kBytes);
  }
  return descriptors;
}

/// Both points of a test as offsets in memory from the corner's pixel.
struct PairOffsets {
  std::ptrdiff_t first;
  std::ptrdiff_t second;
};

/// The pattern turned by an angle, in an image of `step` bytes a row.
std::vector<PairOffsets> turned_pattern(const std::vector<BriefPair>& pattern, float angle_deg, std::ptrdiff_t step) {
  const double angle_rad = static_cast<double>(angle_deg) * std::numbers::pi / 180;
  const double cosine = std::cos(angle_rad);
  const double sine = std::sin(angle_rad);
  const auto offset = [&](int x, int y) {
    return cvRound(x * sine + y * cosine) * step + cvRound(x * cosine - y * sine);
  };
  std::vector<PairOffsets> offsets;
  offsets.reserve(pattern.size());
  for (const BriefPair& pair : pattern) offsets.push_back({offset(pair.x1, pair.y1), offset(pair.x2, pair.y2)});
  return offsets;
}

std::vector<std::uint8_t> describe_by_brief(const cv::Mat& gray, const std::vector<Corner>& corners,
                                            const std::vector<float>& angles_deg, int bits) {
  const std::vector<BriefPair> pattern = make_brief_pattern(bits, kBriefPatternSeed);
  const std::size_t bytes = pattern.size() / 8;
  cv::Mat smooth;
  cv::GaussianBlur(gray, smooth, cv::Size(7, 7), 2, 2, cv::BORDER_REFLECT_101);
  const auto step = static_cast<std::ptrdiff_t>(smooth.step);
  std::vector<std::uint8_t> descriptors(corners.size() * bytes);
  std::vector<PairOffsets> offsets;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // Upright corners share one angle.
    if (i == 0 || angles_deg[i] != angles_deg[i - 1]) offsets = turned_pattern(pattern, angles_deg[i], step);
    const std::uint8_t* const center = smooth.ptr<std::uint8_t>(corners[i].y) + corners[i].x;
    for (std::size_t byte = 0; byte < bytes; ++byte) {
      unsigned packed = 0;
      for (std::size_t bit = 0; bit < 8; ++bit) {
        const PairOffsets& pair = offsets[byte * 8 + bit];
        packed |= static_cast<unsigned>(center[pair.first] < center[pair.second]) << bit;
      }
      descriptors[i * bytes + byte] = static_cast<std::uint8_t>(packed);
    }
  }
  return descriptors;
}

}  // namespace

float centroid_angle_deg(const cv::Mat& gray, int x, int y) {
  static const auto kHalfWidths = disc_half_widths();
  int moment_x = 0;
  int moment_y = 0;
  for (int row = -kCentroidRadiusPx; row <= kCentroidRadiusPx; ++row) {
    const int half = kHalfWidths[static_cast<std::size_t>(std::abs(row))];
    const auto* const line = gray.ptr<std::uint8_t>(y + row) + x;
    int sum = 0;
    for (int col = -half; col <= half; ++col) {
      moment_x += col * line[col];
      sum += line[col];
    }
    moment_y += row * sum;
  }
  const double angle_deg = std::atan2(moment_y, moment_x) * 180 / std::numbers::pi;
  const auto wrapped = static_cast<float>(angle_deg < 0 ? angle_deg + 360 : angle_deg);
  return wrapped < 360 ? wrapped : 0;
}

std::vector<std::uint8_t> describe_corners(const cv::Mat& gray, const std::vector<Corner>& corners,
                                           const std::vector<float>& angles_deg, const BinaryDescriptor& descriptor) {
  if (corners.empty()) return {};
  switch (descriptor.pattern) {
    case DescriptorPattern::kOrb:
      return describe_by_orb(gray, corners, angles_deg);
    case DescriptorPattern::kBrief:
      return describe_by_brief(gray, corners, angles_deg, descriptor.bits);
  }
  throw std::logic_error("a descriptor's pattern is not known");
}

}  // namespace pilotage
