#include "pilotage/raster/block_limits.h"

#include <cstdint>
#include <string>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr std::int64_t kMostSequentialPixels = std::int64_t{1} << 30;  // ten seconds of decoding for each that reads
constexpr std::int64_t kMostBlockBytes = std::int64_t{512} << 20;      // decoded, by each thread

std::string size_text(std::int64_t width_px, std::int64_t height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px) + " px";
}

}  // namespace

void check_blocks(const ImageryInfo& info, int value_bytes) {
  const std::string remedy =
      "; make tiles of it: gdal_translate -co TILED=YES -co COMPRESS=DEFLATE -co BIGTIFF=IF_SAFER";
  const std::string size = size_text(info.width_px, info.height_px);
  const bool sequential = info.driver == "JPEG" || info.driver == "PNG";
  if (sequential && std::int64_t{info.width_px} * info.height_px > kMostSequentialPixels) {
    throw DataError(info.dataset + ": has " + size + ", and a " + info.driver +
                    " is decoded from its top for each part, so at most " + std::to_string(kMostSequentialPixels) +
                    " px are read" + remedy);
  }
  const std::int64_t block_bytes = std::int64_t{info.block_width_px} * info.block_height_px * value_bytes;
  if (block_bytes > kMostBlockBytes) {
    throw DataError(info.dataset + ": holds its " + size + " in blocks of " +
                    size_text(info.block_width_px, info.block_height_px) + ", " + std::to_string(block_bytes) +
                    " bytes; at most " + std::to_string(kMostBlockBytes) + " are decoded at once" + remedy);
  }
}

}  // namespace pilotage
