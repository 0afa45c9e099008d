#include "pilotage/mapdb/chip_codec.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <zstd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/vision/direction_field.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Directions that change along with the place, none at some pixels; pixels drawn as holes are not valid.
ChipPicture make_picture(int width, int height, double holes, std::uint64_t seed, int factor = 2) {
  Random random(seed);
  ChipPicture picture{cv::Mat::zeros(height, width, CV_8UC1), cv::Mat::zeros(height, width, CV_8UC1), factor};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      if (random.uniform() < holes) continue;
      picture.valid.at<std::uint8_t>(row, col) = 255;
      if (random.uniform() < 0.4) continue;
      const double wave = std::sin(col * 0.11) * std::cos(row * 0.07) + 0.1 * random.uniform(-1, 1);
      const int sector = static_cast<int>(std::floor(kDirectionSectors * (wave + 4))) % kDirectionSectors;
      picture.steps.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(1 + sector);
    }
  }
  return picture;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(ChipCodec, GivesBackEveryPixel) {
  const std::uint64_t seed = seed_from_name("GivesBackEveryPixel");
  for (const double holes : {0.0, 0.3, 1.0}) {
    for (const cv::Size& size : {cv::Size(1, 1), cv::Size(7, 1), cv::Size(1, 9), cv::Size(63, 41)}) {
      for (const int factor : {1, 2, kMaxChipFactor}) {
        const ChipPicture picture = make_picture(size.width, size.height, holes, seed, factor);
        const MapChip chip = encode_chip(picture, 17, 1, 640, 1280);
        EXPECT_EQ(chip.tile_id, 17);
        EXPECT_EQ(chip.level, 1);
        EXPECT_EQ(chip.window, (PixelWindow{640, 1280, size.width * factor, size.height * factor}));
        EXPECT_EQ(chip.encoding, kChipEncoding);
        const ChipPicture back = decode_chip(chip, "map.gpkg");
        EXPECT_TRUE(same(back.steps, picture.steps)) << size << holes;
        EXPECT_TRUE(same(back.valid, picture.valid)) << size << holes;
        EXPECT_EQ(back.factor, factor);
      }
    }
  }
}

TEST(ChipCodec, DirectionsWhereThereIsNoGroundAreNotKept) {
  ChipPicture picture = make_picture(20, 10, 0, 8);
  picture.valid.colRange(5, 9).setTo(0);
  const ChipPicture back = decode_chip(encode_chip(picture, 1, 0, 0, 0), "map.gpkg");
  EXPECT_EQ(cv::countNonZero(back.steps.colRange(5, 9)), 0);
  picture.steps.setTo(0, picture.valid == 0);
  EXPECT_TRUE(same(back.steps, picture.steps));
}

TEST(ChipCodec, LinesAndHolesInOnePieceTakeFewerBytes) {
  const std::uint64_t seed = seed_from_name("LinesAndHoles");
  const std::size_t whole = encode_chip(make_picture(128, 128, 0, seed), 1, 0, 0, 0).data.size();
  EXPECT_LT(whole, 128 * 128 * 3 / 8) << "of 9 steps, 3.2 bits if they had nothing in common";
  ChipPicture half = make_picture(128, 128, 0, seed);
  half.valid(cv::Rect(0, 0, 64, 128)).setTo(0);
  EXPECT_LT(static_cast<double>(encode_chip(half, 1, 0, 0, 0).data.size()), 0.6 * static_cast<double>(whole));
}

// The bytes as schemas/pilotage_descriptors.md writes them down, taken apart by hand.
TEST(ChipCodec, BytesAreThoseOfTheSpecification) {
  const ChipPicture picture{(cv::Mat_<std::uint8_t>(2, 4) << 3, 2, 0, 8, 0, 1, 0, 8),
                            (cv::Mat_<std::uint8_t>(2, 4) << 255, 255, 0, 255, 255, 255, 255, 255), 2};
  const MapChip chip = encode_chip(picture, 5, 0, 8, 4);
  ASSERT_GT(chip.data.size(), 3u);
  EXPECT_EQ(std::vector<std::uint8_t>(chip.data.begin(), chip.data.begin() + 3), (std::vector<std::uint8_t>{2, 0, 1}));
  std::vector<std::uint8_t> plain(64);
  plain.resize(ZSTD_decompress(plain.data(), plain.size(), chip.data.data() + 3, chip.data.size() - 3));
  // Neighbours: none 3 2 none / none, above 2, left 1, above 8.
  EXPECT_EQ(plain, (std::vector<std::uint8_t>{0b11111011, 3, 8, 0, 8, 0, 8, 0, 1}));
}

TEST(ChipCodec, RefusesWhatCannotBeStored) {
  const ChipPicture good = make_picture(4, 4, 0, 1);
  EXPECT_THROW(encode_chip({good.steps, good.valid, 0}, 1, 0, 0, 0), UsageError);
  EXPECT_THROW(encode_chip({good.steps, good.valid, kMaxChipFactor + 1}, 1, 0, 0, 0), UsageError);
  EXPECT_THROW(encode_chip({cv::Mat(), cv::Mat(), 1}, 1, 0, 0, 0), UsageError);
  EXPECT_THROW(encode_chip({good.steps, good.valid(cv::Rect(0, 0, 2, 2)), 1}, 1, 0, 0, 0), UsageError);
  const cv::Mat nine(4, 4, CV_8UC1, cv::Scalar(kDirectionSectors + 1));
  EXPECT_THROW(encode_chip({nine, good.valid, 1}, 1, 0, 0, 0), UsageError);
  const cv::Mat large = cv::Mat::zeros(1, kMaxChipPixels + 1, CV_8UC1);
  EXPECT_THROW(encode_chip({large, large, 1}, 1, 0, 0, 0), UsageError);
}

/// The message of the DataError that decoding gives, or "" when it gives a picture.
std::string what_decoding_says(const MapChip& chip) {
  try {
    const ChipPicture picture = decode_chip(chip, "map.gpkg");
    EXPECT_EQ(picture.steps.size(), picture.valid.size());
    EXPECT_TRUE(cv::checkRange(picture.steps, true, nullptr, 0, kDirectionSectors + 1));
    EXPECT_EQ(picture.steps.cols * picture.factor, chip.window.width);
    EXPECT_EQ(picture.steps.rows * picture.factor, chip.window.height);
    return "";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), StartsWith("map.gpkg: tile 17, level 1: chip"));
    return error.what();
  }
}

TEST(ChipCodec, RefusesEveryTruncation) {
  for (const double holes : {0.0, 0.2}) {
    MapChip chip = encode_chip(make_picture(31, 23, holes, 5), 17, 1, 0, 0);
    while (!chip.data.empty()) {
      chip.data.pop_back();
      EXPECT_NE(what_decoding_says(chip), "") << chip.data.size();
    }
  }
}

TEST(ChipCodec, SurvivesFlippedBitsAndInventedBytes) {
  const MapChip good = encode_chip(make_picture(31, 23, 0.2, 6), 17, 1, 0, 0);
  for (std::size_t bit = 0; bit < good.data.size() * 8; ++bit) {
    MapChip chip = good;
    chip.data[bit / 8] = static_cast<std::uint8_t>(chip.data[bit / 8] ^ (1U << (bit % 8)));
    what_decoding_says(chip);
  }
  Random random(seed_from_name("SurvivesFlippedBitsAndInventedBytes"));
  for (int round = 0; round < 2000; ++round) {
    MapChip chip = good;
    const std::size_t first = random.below(good.data.size());
    for (std::size_t i = first; i < std::min(first + 8, good.data.size()); ++i) {
      chip.data[i] = static_cast<std::uint8_t>(random.below(256));
    }
    chip.window.width = 1 + static_cast<int>(random.below(100));
    what_decoding_says(chip);
  }
}

MapChip with_plain_bytes(MapChip chip, const std::vector<std::uint8_t>& plain) {
  chip.data.resize(3 + ZSTD_compressBound(plain.size()));
  chip.data.resize(3 + ZSTD_compress(chip.data.data() + 3, chip.data.size() - 3, plain.data(), plain.size(), 1));
  return chip;
}

TEST(ChipCodec, NamesWhatIsWrong) {
  const MapChip good = encode_chip(make_picture(8, 8, 0, 7), 17, 1, 0, 0);
  MapChip chip = good;
  chip.encoding = "gray8+zlib";
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip has encoding \"gray8+zlib\", expected directions1+zstd"));
  chip = good;
  chip.window.width = 17;
  EXPECT_THAT(what_decoding_says(chip),
              HasSubstr("17 × 16 px from column 0, row 0 is not in multiples of its factor 2"));
  chip = good;
  chip.window.row = 5;
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("row 5 is not in multiples of its factor 2"));
  chip = good;
  chip.window.height = 18;
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("not a zstd frame of 72 bytes"));
  chip = good;
  chip.window = {0, 0, kMaxMapWindowPx, kMaxMapWindowPx};
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip has 32768 × 32768 px, more than 4194304"));
  for (const auto& [at, value] : {std::pair(0, 0), std::pair(1, 1), std::pair(2, 2)}) {
    chip = good;
    chip.data[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(value);
    EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip header is damaged")) << at;
  }
  chip = with_plain_bytes(good, std::vector<std::uint8_t>(64, 9));
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip has turn 9, expected at most 8"));
  chip = with_plain_bytes(good, std::vector<std::uint8_t>(8 + 64, 1));  // a mask of few bits, and directions everywhere
  chip.data[2] = 1;
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip has a direction where it has no ground"));
}

}  // namespace
}  // namespace pilotage
