#include "pilotage/mapdb/chip_codec.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <zstd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Smooth ground with noise between `low` and `high`; pixels drawn as holes are not valid.
ChipPicture make_picture(int width, int height, int low, int high, double holes, std::uint64_t seed, int factor = 2) {
  Random random(seed);
  ChipPicture picture{cv::Mat::zeros(height, width, CV_8UC1), cv::Mat::zeros(height, width, CV_8UC1), factor};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      if (random.uniform() < holes) continue;
      const double wave = 0.5 + 0.35 * std::sin(col * 0.21) * std::cos(row * 0.13) + 0.15 * random.uniform(-1, 1);
      picture.gray.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(std::lround(low + wave * (high - low)));
      picture.valid.at<std::uint8_t>(row, col) = 255;
    }
  }
  return picture;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

double largest_error(const ChipPicture& a, const ChipPicture& b) {
  return cv::norm(a.gray, b.gray, cv::NORM_INF, a.valid);
}

TEST(ChipCodec, EightBitsGiveBackEveryPixel) {
  const std::uint64_t seed = seed_from_name("EightBitsGiveBackEveryPixel");
  for (const double holes : {0.0, 0.3, 1.0}) {
    for (const cv::Size& size : {cv::Size(1, 1), cv::Size(7, 1), cv::Size(1, 9), cv::Size(63, 41)}) {
      for (const int factor : {1, 2, kMaxChipFactor}) {
        const ChipPicture picture = make_picture(size.width, size.height, 0, 255, holes, seed, factor);
        const MapChip chip = encode_chip(picture, 17, 1, 640, 1280, 8);
        EXPECT_EQ(chip.tile_id, 17);
        EXPECT_EQ(chip.level, 1);
        EXPECT_EQ(chip.window, (PixelWindow{640, 1280, size.width * factor, size.height * factor}));
        EXPECT_EQ(chip.encoding, kChipEncoding);
        const ChipPicture back = decode_chip(chip, "map.gpkg");
        EXPECT_TRUE(same(back.gray, picture.gray)) << size << holes;
        EXPECT_TRUE(same(back.valid, picture.valid)) << size << holes;
        EXPECT_EQ(back.factor, factor);
      }
    }
  }
}

TEST(ChipCodec, KeepsGrayWithinHalfAStepOfItsOwnContrast) {
  const std::uint64_t seed = seed_from_name("KeepsGrayWithinHalfAStep");
  for (const auto& [low, high] : {std::pair(0, 255), std::pair(90, 130), std::pair(200, 203), std::pair(7, 7)}) {
    const ChipPicture picture = make_picture(60, 50, low, high, 0.1, seed);
    double darkest = 0;
    double brightest = 0;
    cv::minMaxLoc(picture.gray, &darkest, &brightest, nullptr, nullptr, picture.valid);
    for (int bits = 1; bits <= 8; ++bits) {
      const ChipPicture back = decode_chip(encode_chip(picture, 1, 0, 0, 0, bits), "map.gpkg");
      const double steps = std::pow(2, bits) - 1;
      EXPECT_LE(largest_error(picture, back), std::ceil((brightest - darkest) / steps / 2)) << low << " " << bits;
      EXPECT_TRUE(same(back.valid, picture.valid));
      EXPECT_EQ(cv::countNonZero(back.gray & ~back.valid), 0) << "gray where there is no ground";
    }
  }
}

TEST(ChipCodec, FewerStepsAndHolesInOnePieceTakeFewerBytes) {
  const std::uint64_t seed = seed_from_name("FewerSteps");
  const ChipPicture whole = make_picture(128, 128, 0, 255, 0, seed);
  std::size_t last = 1 << 20;
  for (const int bits : {8, 6, 4, 2}) {
    const std::size_t size = encode_chip(whole, 1, 0, 0, 0, bits).data.size();
    EXPECT_LT(size, last);
    last = size;
  }
  ChipPicture half = make_picture(128, 128, 0, 255, 0, seed);
  half.valid(cv::Rect(0, 0, 64, 128)).setTo(0);
  EXPECT_LT(encode_chip(half, 1, 0, 0, 0, 4).data.size(), 0.6 * encode_chip(whole, 1, 0, 0, 0, 4).data.size());
}

// The bytes as schemas/pilotage_descriptors.md writes them down, taken apart by hand.
TEST(ChipCodec, BytesAreThoseOfTheSpecification) {
  ChipPicture picture{(cv::Mat_<std::uint8_t>(2, 3) << 10, 40, 0, 20, 70, 50),
                      (cv::Mat_<std::uint8_t>(2, 3) << 255, 255, 0, 255, 255, 255), 2};
  const MapChip chip = encode_chip(picture, 5, 0, 8, 4, 2);  // steps 10, 30, 50, 70
  ASSERT_GT(chip.data.size(), 6u);
  EXPECT_EQ(std::vector<std::uint8_t>(chip.data.begin(), chip.data.begin() + 6),
            (std::vector<std::uint8_t>{2, 0, 10, 70, 3, 1}));
  std::vector<std::uint8_t> plain(64);
  plain.resize(ZSTD_decompress(plain.data(), plain.size(), chip.data.data() + 6, chip.data.size() - 6));
  // Steps 0 2 (2) / 1 3 2; predicted 0 0 2 / 0, median(1, 2, 1 + 2 − 0) = 2, median(3, 2, 3 + 2 − 2) = 3.
  EXPECT_EQ(plain, (std::vector<std::uint8_t>{0b111011, 0, 2, 0, 1, 1, 3}));
}

TEST(ChipCodec, ReducesToMeansOfValidPixels) {
  const cv::Mat gray = (cv::Mat_<std::uint8_t>(2, 6) << 10, 20, 1, 2, 9, 9, 30, 41, 3, 200, 9, 9);
  const cv::Mat valid = (cv::Mat_<std::uint8_t>(2, 6) << 255, 255, 255, 255, 0, 0, 255, 255, 0, 0, 0, 255);
  const ChipPicture picture = reduce_to_chip(gray, valid, 2);
  EXPECT_TRUE(same(picture.gray, (cv::Mat_<std::uint8_t>(1, 3) << 25, 2, 0)));
  EXPECT_TRUE(same(picture.valid, (cv::Mat_<std::uint8_t>(1, 3) << 255, 255, 0)));
  EXPECT_EQ(picture.factor, 2);
  EXPECT_THROW(reduce_to_chip(gray, valid, 4), UsageError);
  EXPECT_THROW(reduce_to_chip(gray, valid(cv::Rect(0, 0, 2, 2)), 2), UsageError);
}

TEST(ChipCodec, ReadsPlainGray) {
  const MapChip chip{3, 0, {10, 20, 3, 2}, "gray8", {1, 2, 3, 4, 5, 6}};
  const ChipPicture picture = decode_chip(chip, "map.gpkg");
  EXPECT_TRUE(same(picture.gray, (cv::Mat_<std::uint8_t>(2, 3) << 1, 2, 3, 4, 5, 6)));
  EXPECT_EQ(cv::countNonZero(picture.valid), 6);
  EXPECT_EQ(picture.factor, 1);
}

TEST(ChipCodec, RefusesWhatCannotBeStored) {
  const ChipPicture good = make_picture(4, 4, 0, 255, 0, 1);
  EXPECT_THROW(encode_chip(good, 1, 0, 0, 0, 0), UsageError);
  EXPECT_THROW(encode_chip(good, 1, 0, 0, 0, 9), UsageError);
  EXPECT_THROW(encode_chip({good.gray, good.valid, 0}, 1, 0, 0, 0, 4), UsageError);
  EXPECT_THROW(encode_chip({good.gray, good.valid, kMaxChipFactor + 1}, 1, 0, 0, 0, 4), UsageError);
  EXPECT_THROW(encode_chip({cv::Mat(), cv::Mat(), 1}, 1, 0, 0, 0, 4), UsageError);
  EXPECT_THROW(encode_chip({good.gray, good.valid(cv::Rect(0, 0, 2, 2)), 1}, 1, 0, 0, 0, 4), UsageError);
  const cv::Mat large(1, kMaxChipPixels + 1, CV_8UC1, cv::Scalar(255));
  EXPECT_THROW(encode_chip({large, large, 1}, 1, 0, 0, 0, 4), UsageError);
}

/// The message of the DataError that decoding gives, or "" when it gives a picture.
std::string what_decoding_says(const MapChip& chip) {
  try {
    const ChipPicture picture = decode_chip(chip, "map.gpkg");
    EXPECT_EQ(picture.gray.size(), picture.valid.size());
    EXPECT_EQ(picture.gray.cols * picture.factor, chip.window.width);
    EXPECT_EQ(picture.gray.rows * picture.factor, chip.window.height);
    return "";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), StartsWith("map.gpkg: tile 17, level 1: chip"));
    return error.what();
  }
}

TEST(ChipCodec, RefusesEveryTruncation) {
  for (const double holes : {0.0, 0.2}) {
    MapChip chip = encode_chip(make_picture(31, 23, 0, 255, holes, 5), 17, 1, 0, 0, 4);
    while (!chip.data.empty()) {
      chip.data.pop_back();
      EXPECT_NE(what_decoding_says(chip), "") << chip.data.size();
    }
  }
}

TEST(ChipCodec, SurvivesFlippedBitsAndInventedBytes) {
  const MapChip good = encode_chip(make_picture(31, 23, 0, 255, 0.2, 6), 17, 1, 0, 0, 4);
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

TEST(ChipCodec, NamesWhatIsWrong) {
  const MapChip good = encode_chip(make_picture(8, 8, 0, 255, 0, 7), 17, 1, 0, 0, 4);
  MapChip chip = good;
  chip.encoding = "gray8+zlib";
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip has encoding \"gray8+zlib\", expected gray8 or chip1+zstd"));
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
  for (const auto& [at, value] : {std::pair(0, 0), std::pair(1, 1), std::pair(5, 2), std::pair(4, 0)}) {
    chip = good;
    chip.data[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(value);
    EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip header is damaged")) << at;
  }
  std::swap(chip.data[2], chip.data[3]);  // brightest below darkest
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip header is damaged"));
  chip = good;
  chip.data[4] = 1;  // two steps, but residuals of sixteen
  EXPECT_THAT(what_decoding_says(chip), HasSubstr("chip has residual"));
}

}  // namespace
}  // namespace pilotage
