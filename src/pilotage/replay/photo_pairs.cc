#include <algorithm>
#include <cmath>
#include <map>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_exif.h"
#include "pilotage/raster/gdal_image_metadata.h"
#include "pilotage/replay/log_frames.h"

namespace pilotage {
namespace {

constexpr double kSameInstant_s = 1;  // EXIF has whole seconds
constexpr std::size_t kMostPhotosByTime = 20'000;

using TimedPhotos = std::vector<std::pair<double, std::size_t>>;

/// Pairs in the order of times, each photo once, at most kSameInstant_s apart.
std::vector<std::optional<std::size_t>> pairs_with_offset(const std::vector<LoggedCapture>& captures,
                                                          const TimedPhotos& photos, double offset_s) {
  std::vector<std::optional<std::size_t>> pairs(captures.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < captures.size(); ++i) {
    const double expected_s = captures[i].time_s + offset_s;
    while (next < photos.size() && photos[next].first < expected_s - kSameInstant_s) ++next;
    if (next < photos.size() && photos[next].first <= expected_s + kSameInstant_s) pairs[i] = photos[next++].second;
  }
  return pairs;
}

std::int64_t pair_count(const std::vector<std::optional<std::size_t>>& pairs) {
  return std::count_if(pairs.begin(), pairs.end(), [](const auto& pair) { return pair.has_value(); });
}

/// The offset that most differences between a photo and a capture agree on, to half a second. Of long flights only the
/// first captures are asked: the vote of some hundred is clear.
double most_voted_offset_s(const std::vector<LoggedCapture>& captures, const TimedPhotos& photos) {
  constexpr std::size_t kVoters = 300;
  std::map<std::int64_t, std::int64_t> votes;
  for (std::size_t i = 0; i < std::min(kVoters, captures.size()); ++i) {
    for (const auto& [time_s, index] : photos) {
      const auto bin = static_cast<std::int64_t>(std::floor((time_s - captures[i].time_s) * 2));
      ++votes[bin];
      ++votes[bin + 1];
    }
  }
  const auto best =
      std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return static_cast<double>(best->first) / 2;
}

/// Pairs with one difference of the clocks.
struct ClockPairs {
  double offset_s = 0;  ///< The photos' clock minus the log's.
  std::vector<std::optional<std::size_t>> pairs;
  std::int64_t count = -1;

  void take_if_more(const std::vector<LoggedCapture>& captures, const TimedPhotos& photos, double other_s) {
    auto other = pairs_with_offset(captures, photos, other_s);
    const std::int64_t other_count = pair_count(other);
    if (other_count > count) *this = {other_s, std::move(other), other_count};
  }
};

ClockPairs pairs_of_most(const std::vector<LoggedCapture>& captures, const TimedPhotos& photos) {
  const double voted_s = most_voted_offset_s(captures, photos);
  ClockPairs most;
  for (int step = -4; step <= 4; ++step) most.take_if_more(captures, photos, voted_s + 0.25 * step);
  return most;
}

/// A camera shows the time of some zone: whole quarters of an hour from UTC, the nearest first.
ClockPairs pairs_of_a_time_zone(const std::vector<LoggedCapture>& captures, const TimedPhotos& photos,
                                double utc_minus_log_s) {
  constexpr int kQuarters = 14 * 4;
  ClockPairs most;
  for (int quarter = 0; quarter <= kQuarters; ++quarter) {
    for (const int sign : {1, -1}) most.take_if_more(captures, photos, utc_minus_log_s + sign * 900.0 * quarter);
  }
  return most;
}

/// Nothing where less than half of the smaller list finds a partner.
std::optional<PhotoPairs> pair_by_time(const std::vector<LoggedCapture>& captures, const TimedPhotos& photos,
                                       std::optional<double> utc_minus_log_s) {
  const auto smaller = static_cast<std::int64_t>(std::min(captures.size(), photos.size()));
  ClockPairs taken = pairs_of_most(captures, photos);
  std::string other;
  if (utc_minus_log_s) {
    ClockPairs of_zone = pairs_of_a_time_zone(captures, photos, *utc_minus_log_s);
    if (2 * of_zone.count >= smaller) {
      if (taken.count > of_zone.count) {
        other = "; were the photos' clock off by another " + format_fixed(taken.offset_s - of_zone.offset_s, 2) +
                " s, " + std::to_string(taken.count) + " would be paired";
      }
      taken = std::move(of_zone);
    }
  }
  if (2 * taken.count < smaller) return std::nullopt;
  const std::string difference = utc_minus_log_s ? "UTC " + format_fixed(taken.offset_s - *utc_minus_log_s, 2)
                                                 : "the log's " + format_fixed(taken.offset_s, 2);
  return PhotoPairs{std::move(taken.pairs),
                    std::to_string(taken.count) + " paired by time, photos' clock minus " + difference + " s; " +
                        std::to_string(std::ssize(captures) - taken.count) + " captures and " +
                        std::to_string(std::ssize(photos) - taken.count) + " photos are left over" + other};
}

}  // namespace

std::vector<Photo> photos_of_folder(const std::filesystem::path& folder) {
  std::vector<Photo> photos;
  for (const std::string& file : pictures_of_folder(folder)) {
    Photo photo{file, {}};
    try {
      photo.taken_s = frame_exif(read_image_metadata((folder / file).string())).taken_s;
    } catch (const DataError&) {
      // A picture that cannot be opened has its place in the order; matching says what is wrong with it.
    }
    photos.push_back(std::move(photo));
  }
  return photos;
}

PhotoPairs pair_photos(const std::vector<LoggedCapture>& captures, const std::vector<Photo>& photos,
                       std::optional<double> utc_minus_log_s) {
  const std::string counts =
      std::to_string(photos.size()) + " photos for " + std::to_string(captures.size()) + " captures of the log";
  if (captures.empty()) throw DataError("the log has no capture or trigger of a camera to pair photos with");
  TimedPhotos timed;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    if (photos[i].taken_s) timed.emplace_back(*photos[i].taken_s, i);
  }
  const bool all_timed = timed.size() == photos.size() && timed.size() <= kMostPhotosByTime;
  if (all_timed) {
    std::sort(timed.begin(), timed.end());
    if (auto pairs = pair_by_time(captures, timed, utc_minus_log_s)) {
      pairs->how = counts + ": " + pairs->how;
      return *std::move(pairs);
    }
  }
  const std::string why = all_timed ? "by time less than half find a partner"
                                    : std::to_string(photos.size() - timed.size()) +
                                          " photos have no DateTimeOriginal in their EXIF (at most " +
                                          std::to_string(kMostPhotosByTime) + " photos are paired by time)";
  if (photos.size() != captures.size()) {
    throw DataError(counts + ", and they cannot be paired: " + why + "; are these the photos of this flight?");
  }
  PhotoPairs result;
  for (std::size_t i = 0; i < photos.size(); ++i) result.photo_of_capture.emplace_back(i);
  result.how = counts + ": paired by the order of their names, for " + why;
  return result;
}

}  // namespace pilotage
