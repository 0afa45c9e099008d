#include "pilotage/raster/shared_blocks.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/geo/tile_groups.h"

namespace pilotage {
namespace {

Raster noise(int width, int height) {
  Random random(seed_from_name("shared blocks"));
  Raster raster{cv::Mat(height, width, CV_16U), cv::Mat(height, width, CV_8U), {}};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      raster.pixels.at<std::uint16_t>(row, col) = static_cast<std::uint16_t>(random.below(65536));
      raster.valid.at<std::uint8_t>(row, col) = random.below(9) == 0 ? 0 : 255;
    }
  }
  return raster;
}

GraySource in_blocks(const Raster& raster, int width, int height) {
  GraySource source = gray_source_from(raster);
  source.block_width_px = width;
  source.block_height_px = height;
  return source;
}

/// Square blocks of nothing in particular, 16 bits, five high; counts those that are made.
GraySource counted_blocks(int side_px, std::int64_t across, int& reads) {
  GraySource source = in_blocks(noise(300, 300), side_px, side_px);
  source.width_px = side_px * across;
  source.height_px = std::int64_t{side_px} * 5;
  source.read = [&reads](const PixelWindow& window) {
    ++reads;
    return Raster{cv::Mat(window.height, window.width, CV_16U), cv::Mat(window.height, window.width, CV_8U), {}};
  };
  return source;
}

TEST(SharedBlocks, OverlappingWindowsOfThreadsReadEachBlockOnce) {
  const Raster raster = noise(1500, 1100);
  GraySource source = in_blocks(raster, 300, 130);
  std::mutex mutex;
  std::map<std::pair<std::int64_t, std::int64_t>, int> reads;
  source.read = [whole = source.read, &mutex, &reads](const PixelWindow& window) {
    const std::lock_guard lock(mutex);
    ++reads[{window.row, window.col}];
    return whole(window);
  };
  const GraySource shared = share_blocks(source);
  EXPECT_EQ(shared.width_px, source.width_px);
  parallel_for(40, 4, [&](std::size_t index, int) {
    Random random(index + 1);
    const auto width = static_cast<int>(1 + random.below(700));
    const auto height = static_cast<int>(1 + random.below(500));
    const PixelWindow window{static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(1500 - width))),
                             static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(1100 - height))), width,
                             height};
    const Raster read = shared.read(window);
    const cv::Rect rect(static_cast<int>(window.col), static_cast<int>(window.row), width, height);
    EXPECT_EQ(cv::norm(read.pixels, raster.pixels(rect), cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(read.valid, raster.valid(rect), cv::NORM_INF), 0);
    EXPECT_EQ(read.map_from_pixel.origin_x, static_cast<double>(window.col));
  });
  EXPECT_GT(reads.size(), 10U);
  for (const auto& [place, count] : reads) {
    EXPECT_EQ(count, 1) << place.first << ", " << place.second;
    EXPECT_EQ(place.first % 260, 0);  // two blocks: at least 256 px
    EXPECT_EQ(place.second % 300, 0);
  }
}

TEST(SharedBlocks, ColoursAndTheirGrayReadEachBlockOnce) {
  ColorSource source;
  source.width_px = 1024;
  source.height_px = 1024;
  source.depth = CV_8U;
  source.block_width_px = 256;
  source.block_height_px = 256;
  int reads = 0;
  source.read = [&reads](const PixelWindow& window) {
    ++reads;
    return Raster{cv::Mat(window.height, window.width, CV_8UC3, cv::Scalar(10, 20, 30)),
                  cv::Mat(window.height, window.width, CV_8U, cv::Scalar(255)),
                  {}};
  };
  const auto read_all = [](const auto& shared) {
    for (std::int64_t row = 0; row < 1000; row += 100)
      EXPECT_EQ(cv::countNonZero(shared.read({1, row, 999, 20}).valid), 999 * 20);
  };
  const ColorSource shared = share_blocks(source, 16 * 256 * 256 * 4);
  read_all(shared);
  EXPECT_EQ(reads, 16);
  read_all(gray_source_of(shared));
  EXPECT_EQ(reads, 16);
  EXPECT_EQ(shared.read({3, 3, 1, 1}).pixels.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(gray_source_of(shared).block_width_px, 256);

  const ColorSource few = share_blocks(source, 256 * 256 * 4);  // three rows of blocks: one of four is dropped
  read_all(few);
  EXPECT_EQ(reads, 32);
  read_all(few);
  EXPECT_EQ(reads, 48);
}

TEST(SharedBlocks, WholeBlocksAreKeptTooWhereAllAre) {
  const Raster raster = noise(1024, 600);
  GraySource source = in_blocks(raster, 512, 256);
  int reads = 0;
  source.read = [whole = source.read, &reads](const PixelWindow& window) {
    ++reads;
    return whole(window);
  };
  const GraySource shared = share_blocks(source);
  shared.read({0, 0, 1024, 256});  // whole blocks
  EXPECT_EQ(reads, 2);
  const Raster part = shared.read({500, 10, 100, 200});
  EXPECT_EQ(reads, 2);
  EXPECT_EQ(cv::norm(part.pixels, raster.pixels(cv::Rect(500, 10, 100, 200)), cv::NORM_INF), 0);
}

/// More than three rows of blocks do not stay.
TEST(SharedBlocks, WhatWasDroppedIsReadAgain) {
  const Raster raster = noise(300, 260);
  GraySource source = in_blocks(raster, 300, 1);
  source.width_px = 300;
  source.height_px = 260 * 1000;  // far more than is kept
  std::atomic<int> reads = 0;
  source.read = [&](const PixelWindow& window) {
    ++reads;
    return Raster{cv::Mat(window.height, window.width, CV_16U, cv::Scalar(static_cast<double>(window.row % 1000))),
                  cv::Mat(window.height, window.width, CV_8U, cv::Scalar(255)),
                  {}};
  };
  const GraySource shared = share_blocks(source);
  for (int round = 0; round < 2; ++round) {
    for (std::int64_t row = 0; row < 256 * 900; row += 256) {
      EXPECT_EQ(shared.read({5, row + 3, 10, 10}).pixels.at<std::uint16_t>(0, 0), row % 1000);
    }
  }
  EXPECT_EQ(reads, 1800);
}

// Three rows of them would take 2.3 GiB.
TEST(SharedBlocks, RowsOfAVeryWideMapAreNotKeptWhole) {
  int reads = 0;
  const GraySource shared = share_blocks(counted_blocks(256, 6000, reads));
  const auto read_row = [&](std::int64_t blocks) {
    for (std::int64_t col = 0; col < 256 * blocks; col += 256) shared.read({col + 3, 5, 10, 10});
  };
  constexpr std::int64_t kKept = (256 << 20) / (256 * 256 * 3);  // 256 MiB of grays and their mask
  read_row(kKept);
  read_row(kKept);
  EXPECT_EQ(reads, kKept);
  read_row(2 * kKept);
  read_row(2 * kKept);
  EXPECT_EQ(reads, 4 * kKept);
}

// What goes down slabs finds three rows of one again, however large its blocks.
TEST(SharedBlocks, RowsOfASlabAreKept) {
  int reads = 0;
  const GraySource shared = share_blocks(counted_blocks(4096, 30, reads));
  constexpr std::int64_t kAcross = kSlabWidth_px / 4096 + 1;  // one lies across the border
  for (int round = 0; round < 2; ++round) {
    for (std::int64_t row = 0; row < 3; ++row) {
      for (std::int64_t col = 0; col < kAcross; ++col) shared.read({4096 * col + 3, 4096 * row + 5, 10, 10});
    }
  }
  EXPECT_EQ(reads, 3 * kAcross);
}

// Each read waits for another one beside it: threads that want the same blocks do not wait for one maker.
TEST(SharedBlocks, ThreadsThatWantTheSameBlocksMakeDifferentOnes) {
  const Raster raster = noise(1024, 512);
  GraySource source = in_blocks(raster, 256, 256);
  std::mutex mutex;
  std::condition_variable begun;
  int reads = 0;
  bool together = false;
  source.read = [&, whole = source.read](const PixelWindow& window) {
    std::unique_lock lock(mutex);
    const int mine = ++reads;
    begun.notify_all();
    constexpr std::chrono::seconds kLongEnough(60);
    if (mine % 2 == 1) together |= begun.wait_for(lock, kLongEnough, [&] { return reads > mine; });
    lock.unlock();
    return whole(window);
  };
  const GraySource shared = share_blocks(source);
  const auto read_all = [&] { shared.read({1, 1, 1022, 510}); };
  std::thread other(read_all);
  read_all();
  other.join();
  EXPECT_EQ(reads, 8);
  EXPECT_TRUE(together);
}

TEST(SharedBlocks, AnErrorIsToldAndTriedAgain) {
  const Raster raster = noise(600, 600);
  GraySource source = in_blocks(raster, 256, 256);
  bool broken = true;
  source.read = [&broken, whole = source.read](const PixelWindow& window) {
    if (broken) throw DataError("broken");
    return whole(window);
  };
  const GraySource shared = share_blocks(source);
  EXPECT_THROW(shared.read({10, 10, 20, 20}), DataError);
  broken = false;
  EXPECT_EQ(shared.read({10, 10, 1, 1}).pixels.at<std::uint16_t>(0, 0), raster.pixels.at<std::uint16_t>(10, 10));
}

TEST(SharedBlocks, PixelsOnTheirOwnAreNotKept) {
  GraySource source = gray_source_from(noise(40, 40));
  int reads = 0;
  source.read = [&reads, whole = source.read](const PixelWindow& window) {
    ++reads;
    return whole(window);
  };
  const GraySource shared = share_blocks(source);
  shared.read({1, 1, 5, 5});
  shared.read({1, 1, 5, 5});
  EXPECT_EQ(reads, 2);
}

}  // namespace
}  // namespace pilotage
