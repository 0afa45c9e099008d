#include "pilotage/vision/feature_descriptor.h"

#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/vision/brief_pattern.h"
#include "pilotage/vision/ground_pattern.h"

namespace pilotage {
namespace {

/// cv::ORB's pattern at given places.
std::vector<std::uint8_t> describe_by_orb(const cv::Mat& gray, const std::vector<Corner>& corners) {
  constexpr std::size_t kBytes = 32;
  std::vector<cv::KeyPoint> keypoints;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    keypoints.emplace_back(static_cast<float>(corners[i].x), static_cast<float>(corners[i].y), 31.0F, 0.0F,
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

/// Test after test of `pattern` at each corner: whether the first point's value is below the second one's.
template <class Value>
std::vector<std::uint8_t> describe_by_pairs(const cv::Mat& values, const std::vector<Corner>& corners,
                                            std::span<const BriefPair> pattern) {
  const auto step = static_cast<std::ptrdiff_t>(values.step1());
  std::vector<PairOffsets> offsets;
  offsets.reserve(pattern.size());
  for (const BriefPair& pair : pattern) {
    offsets.push_back({pair.y1 * step + pair.x1, pair.y2 * step + pair.x2});
  }
  std::vector<std::uint8_t> descriptors(corners.size() * pattern.size() / 8);
  std::uint8_t* out = descriptors.data();
  for (const Corner& corner : corners) {
    const Value* const center = values.ptr<Value>(corner.y) + corner.x;
    for (const PairOffsets* pair = offsets.data(); pair != offsets.data() + offsets.size(); pair += 8) {
      unsigned packed = 0;
      for (unsigned bit = 0; bit < 8; ++bit) {
        packed |= static_cast<unsigned>(center[pair[bit].first] < center[pair[bit].second]) << bit;
      }
      *out++ = static_cast<std::uint8_t>(packed);
    }
  }
  return descriptors;
}

std::vector<std::uint8_t> describe_by_brief(const cv::Mat& gray, const std::vector<Corner>& corners, int bits) {
  cv::Mat smooth;
  cv::GaussianBlur(gray, smooth, cv::Size(7, 7), 2, 2, cv::BORDER_REFLECT_101);
  return describe_by_pairs<std::uint8_t>(smooth, corners, make_brief_pattern(bits, kBriefPatternSeed));
}

/// Sums of whole numbers: equal on every machine, and no two that differ become equal by rounding.
std::vector<std::uint8_t> describe_by_ground(const cv::Mat& gray, const std::vector<Corner>& corners, int bits) {
  constexpr int kSide = 2 * kGroundBoxRadiusPx + 1;
  cv::Mat sums;
  cv::boxFilter(gray, sums, CV_16U, cv::Size(kSide, kSide), cv::Point(-1, -1), false, cv::BORDER_REFLECT_101);
  return describe_by_pairs<std::uint16_t>(sums, corners,
                                          std::span(kGroundPattern).first(static_cast<std::size_t>(bits)));
}

}  // namespace

std::vector<std::uint8_t> describe_corners(const cv::Mat& gray, const std::vector<Corner>& corners,
                                           const BinaryDescriptor& descriptor) {
  if (corners.empty()) return {};
  switch (descriptor.pattern) {
    case DescriptorPattern::kGround:
      return describe_by_ground(gray, corners, descriptor.bits);
    case DescriptorPattern::kOrb:
      return describe_by_orb(gray, corners);
    case DescriptorPattern::kBrief:
      return describe_by_brief(gray, corners, descriptor.bits);
  }
  throw std::logic_error("a descriptor's pattern is not known");
}

}  // namespace pilotage
