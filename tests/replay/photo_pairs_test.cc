#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/replay/log_frames.h"

namespace pilotage {
namespace {

std::vector<LoggedCapture> captures_at(const std::vector<double>& times_s) {
  std::vector<LoggedCapture> captures;
  for (const double time_s : times_s) {
    captures.emplace_back();
    captures.back().time_s = time_s;
  }
  return captures;
}

std::vector<Photo> photos_at(const std::vector<double>& times_s) {
  std::vector<Photo> photos;
  for (const double time_s : times_s) photos.push_back({"p" + std::to_string(photos.size()), time_s});
  return photos;
}

TEST(PhotoPairs, AsManyAreInOrder) {
  const PhotoPairs pairs = pair_photos(captures_at({1, 2, 3}), {{"a", {}}, {"b", {}}, {"c", {}}});
  EXPECT_EQ(pairs.photo_of_capture[2], 2U);
  EXPECT_EQ(pairs.how, "3 photos for 3 captures of the log: paired by their order");
}

TEST(PhotoPairs, MissingPhotoIsFoundByTime) {
  // Unequal distances, whole seconds of the photos' clock; the one at 17 is missing.
  const std::vector<LoggedCapture> captures = captures_at({10.3, 12.1, 17.2, 19.9, 26.5, 31.4});
  const PhotoPairs pairs =
      pair_photos(captures, photos_at({1700000010, 1700000012, 1700000019, 1700000026, 1700000031}));
  ASSERT_EQ(pairs.photo_of_capture.size(), 6U);
  EXPECT_EQ(pairs.photo_of_capture[1], 1U);
  EXPECT_FALSE(pairs.photo_of_capture[2]);
  EXPECT_EQ(pairs.photo_of_capture[3], 2U);
  EXPECT_EQ(pairs.photo_of_capture[5], 4U);
  EXPECT_NE(pairs.how.find("5 photos for 6 captures of the log: 5 paired by time"), std::string::npos) << pairs.how;
  EXPECT_NE(pairs.how.find("1 captures and 0 photos are left over"), std::string::npos) << pairs.how;
}

TEST(PhotoPairs, WhatCannotBePairedIsAnError) {
  EXPECT_THROW(pair_photos({}, photos_at({1})), DataError);
  EXPECT_THROW(pair_photos(captures_at({1, 2}), {{"a", {}}}), DataError) << "no time";
  EXPECT_THROW(pair_photos(captures_at({0, 100, 250, 470, 700, 1000}), photos_at({5, 12, 26, 33, 47, 58, 69})),
               DataError)
      << "of another flight";
}

}  // namespace
}  // namespace pilotage
