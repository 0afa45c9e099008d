#include <fstream>

#include "testing/temporary_folder.h"
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

TEST(PhotoPairs, WithoutTimesAsManyAreInOrder) {
  const PhotoPairs pairs = pair_photos(captures_at({1, 2, 3}), {{"a", {}}, {"b", {}}, {"c", {}}}, {});
  EXPECT_EQ(pairs.photo_of_capture[2], 2U);
  EXPECT_EQ(pairs.how,
            "3 photos for 3 captures of the log: paired by the order of their names, for 3 photos have no "
            "DateTimeOriginal in their EXIF (at most 20000 photos are paired by time)");
}

TEST(PhotoPairs, TimesComeBeforeTheOrderOfNames) {
  // Names begin anew in the middle: the third is the first by name.
  const PhotoPairs pairs = pair_photos(captures_at({0, 10, 25}), photos_at({25, 0, 10}), 0.0);
  EXPECT_EQ(pairs.photo_of_capture, (std::vector<std::optional<std::size_t>>{1, 2, 0}));
}

TEST(PhotoPairs, ATimeZoneComesBeforeAnyOtherDifferenceOfTheClocks) {
  // One capture gave no picture, one picture was taken after the last: ten seconds more would pair all of them.
  const PhotoPairs pairs =
      pair_photos(captures_at({0, 10, 20, 30, 40}), photos_at({17210, 17220, 17230, 17240, 17250}), 10000.0);
  EXPECT_EQ(pairs.photo_of_capture, (std::vector<std::optional<std::size_t>>{{}, 0, 1, 2, 3}));
  EXPECT_NE(pairs.how.find("photos' clock minus UTC 7200.00 s; 1 captures and 1 photos are left over; were the photos' "
                           "clock off by another 9.00 s, 5 would be paired"),
            std::string::npos)
      << pairs.how;
  // A clock that is off by half a minute besides, at distances that tell it.
  const PhotoPairs off = pair_photos(captures_at({0, 10, 25, 47}), photos_at({33, 43, 58, 80}), 0.0);
  EXPECT_EQ(off.photo_of_capture, (std::vector<std::optional<std::size_t>>{0, 1, 2, 3}));
}

TEST(PhotoPairs, TimesThatFitNothingLeaveTheOrder) {
  const PhotoPairs pairs = pair_photos(captures_at({0, 100, 250, 470}), photos_at({5, 5, 5, 5}), 0.0);
  EXPECT_EQ(pairs.photo_of_capture[3], 3U);
  EXPECT_NE(pairs.how.find("by the order of their names, for by time less than half"), std::string::npos) << pairs.how;
}

TEST(PhotoPairs, NumbersInNamesAreNumbers) {
  const testing::TemporaryFolder folder;
  for (const char* name :
       {"IMG_10.png", "IMG_9.png", "IMG_0011.png", "b.png", "IMG_009.png", "a2b10.png", "a2b9.png"}) {
    std::ofstream(folder / name) << "no picture";
  }
  std::vector<std::string> names;
  for (const Photo& photo : photos_of_folder(folder.path())) names.push_back(photo.file);
  EXPECT_EQ(names, (std::vector<std::string>{"IMG_009.png", "IMG_9.png", "IMG_10.png", "IMG_0011.png", "a2b9.png",
                                             "a2b10.png", "b.png"}));
}

TEST(PhotoPairs, MissingPhotoIsFoundByTime) {
  // Unequal distances, whole seconds of the photos' clock; the one at 17 is missing.
  const std::vector<LoggedCapture> captures = captures_at({10.3, 12.1, 17.2, 19.9, 26.5, 31.4});
  const PhotoPairs pairs =
      pair_photos(captures, photos_at({1700000010, 1700000012, 1700000019, 1700000026, 1700000031}), {});
  ASSERT_EQ(pairs.photo_of_capture.size(), 6U);
  EXPECT_EQ(pairs.photo_of_capture[1], 1U);
  EXPECT_FALSE(pairs.photo_of_capture[2]);
  EXPECT_EQ(pairs.photo_of_capture[3], 2U);
  EXPECT_EQ(pairs.photo_of_capture[5], 4U);
  EXPECT_NE(pairs.how.find("5 photos for 6 captures of the log: 5 paired by time"), std::string::npos) << pairs.how;
  EXPECT_NE(pairs.how.find("1 captures and 0 photos are left over"), std::string::npos) << pairs.how;
}

TEST(PhotoPairs, WhatCannotBePairedIsAnError) {
  EXPECT_THROW(pair_photos({}, photos_at({1}), {}), DataError);
  EXPECT_THROW(pair_photos(captures_at({1, 2}), {{"a", {}}}, {}), DataError) << "no time";
  EXPECT_THROW(pair_photos(captures_at({0, 100, 250, 470, 700, 1000}), photos_at({5, 12, 26, 33, 47, 58, 69}), {}),
               DataError)
      << "of another flight";
}

}  // namespace
}  // namespace pilotage
