#include "pilotage/capture/ortho_mosaic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <mutex>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/capture/map_error.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

constexpr std::int64_t kFrameBytes = std::int64_t{1} << 30;
constexpr int kBlock_px = 512;
constexpr int kLattice_px = kMapCell_px;
constexpr int kNodes = kBlock_px / kLattice_px + 1;
/// Width of the band in which one frame fades into the next.
constexpr double kFeather_px = 24;
/// The outermost pixels of a frame, where interpolation has no neighbour.
constexpr double kEdge_px = 1.5;
constexpr float kNotSeen = std::numeric_limits<float>::infinity();

/// Frames in memory, the last ones used.
class FrameCache {
 public:
  FrameCache(const OrthoMosaic& mosaic, std::int64_t bytes) : mosaic_(mosaic), bytes_(bytes) {}

  std::shared_ptr<const cv::Mat> get(std::size_t frame) {
    std::shared_ptr<Slot> slot;
    {
      const std::lock_guard lock(mutex_);
      std::shared_ptr<Slot>& found = slots_[frame];
      if (!found) {
        found = std::make_shared<Slot>();
        order_.push_front(frame);
        found->place = order_.begin();
      } else {
        order_.splice(order_.begin(), order_, found->place);
      }
      slot = found;
      drop_oldest();
    }
    const std::lock_guard loading(slot->loading);
    if (!slot->pixels) slot->pixels = std::make_shared<const cv::Mat>(mosaic_.load(frame));
    return slot->pixels;
  }

 private:
  struct Slot {
    std::mutex loading;
    std::shared_ptr<const cv::Mat> pixels;
    std::list<std::size_t>::iterator place;
  };

  void drop_oldest() {
    const Camera& camera = mosaic_.block->camera;
    const std::int64_t of_one = std::int64_t{3} * camera.width_px * camera.height_px;
    const auto most = static_cast<std::size_t>(std::max<std::int64_t>(2, bytes_ / of_one));
    while (order_.size() > most) {
      slots_.erase(order_.back());
      order_.pop_back();
    }
  }

  const OrthoMosaic& mosaic_;
  std::int64_t bytes_;
  std::mutex mutex_;
  std::map<std::size_t, std::shared_ptr<Slot>> slots_;
  std::list<std::size_t> order_;
};

/// The ground under the nodes of a block's lattice.
struct BlockGround {
  std::int64_t col = 0;
  std::int64_t row = 0;
  int width = 0;
  int height = 0;
  std::array<Eigen::Vector3d, std::size_t{kNodes} * kNodes> nodes_enu_m;  ///< z NaN where the ground is not known.
  Eigen::Vector2d low_m;
  Eigen::Vector2d high_m;
};

BlockGround ground_of_block(const OrthoMosaic& mosaic, const CrsTransform& transform, std::int64_t col,
                            std::int64_t row) {
  BlockGround ground;
  ground.col = col;
  ground.row = row;
  ground.width = static_cast<int>(std::min<std::int64_t>(kBlock_px, mosaic.width_px - col));
  ground.height = static_cast<int>(std::min<std::int64_t>(kBlock_px, mosaic.height_px - row));
  ground.low_m.setConstant(std::numeric_limits<double>::infinity());
  ground.high_m = -ground.low_m;
  for (int y = 0; y < kNodes; ++y) {
    for (int x = 0; x < kNodes; ++x) {
      Eigen::Vector3d& node = ground.nodes_enu_m[static_cast<std::size_t>(y * kNodes + x)];
      node.setConstant(std::numeric_limits<double>::quiet_NaN());
      const auto point = transform.geodetic_from_map(mosaic.map_from_pixel.map_from_pixel(
          {static_cast<double>(col + x * kLattice_px), static_cast<double>(row + y * kLattice_px)}));
      if (!point) continue;
      const Eigen::Vector2d en_m = east_north_m(mosaic.frame, *point);
      node << en_m, mosaic.ground->heights.height_m(en_m);
      ground.low_m = ground.low_m.cwiseMin(en_m);
      ground.high_m = ground.high_m.cwiseMax(en_m);
    }
  }
  return ground;
}

/// Where a frame sees the pixels of a block.
struct FrameOverBlock {
  std::size_t frame = 0;
  cv::Mat place_px;      ///< CV_32FC2: column and row in the frame, first pixel centre at 0 (as cv::remap has them).
  cv::Mat off_nadir_m2;  ///< CV_32F: square of the distance from the point below the camera; kNotSeen outside.
  Eigen::Vector2d nadir_m{0, 0};
};

template <class Value>
Value between(const std::array<Value, 4>& corners, float x, float y) {
  return (corners[0] * (1 - x) + corners[1] * x) * (1 - y) + (corners[2] * (1 - x) + corners[3] * x) * y;
}

std::optional<FrameOverBlock> look_from(const OrthoMosaic& mosaic, const Lens& lens, const BlockGround& ground,
                                        std::size_t frame) {
  const FramePose& pose = mosaic.block->poses[frame];
  const Camera& camera = mosaic.block->camera;
  const Eigen::Vector2d nadir = pose.center_enu_m.head<2>();
  std::array<Eigen::Vector3f, std::size_t{kNodes} * kNodes> nodes;  // column, row, distance²
  Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Vector2f high = -low;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    const Eigen::Vector3d& point = ground.nodes_enu_m[i];
    if (!std::isfinite(point.z())) continue;
    const auto pixel = pixel_from_ray(lens, pose.enu_from_camera.transpose() * (point - pose.center_enu_m));
    if (!pixel) continue;
    nodes[i] << static_cast<float>(pixel->x() - 0.5), static_cast<float>(pixel->y() - 0.5),
        static_cast<float>((point.head<2>() - nadir).squaredNorm());
    low = low.cwiseMin(nodes[i].head<2>());
    high = high.cwiseMax(nodes[i].head<2>());
  }
  const bool meets = high.x() >= 0 && high.y() >= 0 && low.x() <= static_cast<float>(camera.width_px) &&
                     low.y() <= static_cast<float>(camera.height_px);
  if (!meets) return std::nullopt;
  FrameOverBlock over{frame, cv::Mat(ground.height, ground.width, CV_32FC2),
                      cv::Mat(ground.height, ground.width, CV_32F, cv::Scalar(static_cast<double>(kNotSeen))), nadir};
  bool seen = false;
  const auto most_col = static_cast<float>(camera.width_px - 1 - kEdge_px);
  const auto most_row = static_cast<float>(camera.height_px - 1 - kEdge_px);
  constexpr auto kLeast = static_cast<float>(kEdge_px);
  for (int y = 0; y < ground.height; ++y) {
    auto* places = over.place_px.ptr<cv::Vec2f>(y);
    auto* distances = over.off_nadir_m2.ptr<float>(y);
    const int node_y = y / kLattice_px;
    const float share_y = (static_cast<float>(y % kLattice_px) + 0.5F) / kLattice_px;
    for (int x = 0; x < ground.width; ++x) {
      const int node_x = x / kLattice_px;
      const float share_x = (static_cast<float>(x % kLattice_px) + 0.5F) / kLattice_px;
      const auto first = static_cast<std::size_t>(node_y * kNodes + node_x);
      const Eigen::Vector3f at = between<Eigen::Vector3f>(
          {nodes[first], nodes[first + 1], nodes[first + kNodes], nodes[first + kNodes + 1]}, share_x, share_y);
      places[x] = {at.x(), at.y()};
      if (at.x() >= kLeast && at.y() >= kLeast && at.x() <= most_col && at.y() <= most_row) {
        distances[x] = at.z();
        seen = true;
      }
    }
  }
  if (!seen) return std::nullopt;
  return over;
}

/// How far a place is from the frame's edge, as a share of the band in which frames fade; 0 … 1.
float edge_share(const Camera& camera, const cv::Vec2f& place) {
  const float to_edge = std::min(std::min(place[0], static_cast<float>(camera.width_px - 1) - place[0]),
                                 std::min(place[1], static_cast<float>(camera.height_px - 1) - place[1]));
  return std::clamp(to_edge / static_cast<float>(2 * kFeather_px), 0.01F, 1.0F);
}

/// exp(−(gain + a·r² + b·r⁴)) of a colour.
float balance_factor(const ColorBalance& balance, std::size_t frame, std::size_t channel, float r2) {
  const auto& [a, b] = balance.falloff[channel];
  return std::exp(-static_cast<float>(balance.log_gain[frame][channel]) -
                  r2 * (static_cast<float>(a) + r2 * static_cast<float>(b)));
}

struct DrawnBlock {
  Raster raster;
  cv::Mat map_sigma_m;  ///< As MosaicStats, of this block.
  cv::Mat cell_frame;
  cv::Mat cell_frames_seen;
  std::vector<std::pair<std::size_t, std::int64_t>> frame_px;
};

class BlockPainter {
 public:
  BlockPainter(const OrthoMosaic& mosaic, FrameCache& cache)
      : mosaic_(mosaic), cache_(cache), lens_(make_lens(mosaic.block->camera)), transform_(mosaic.crs) {
    for (const FramePose& pose : mosaic.block->poses) reaches_m_.push_back(reach_m(pose));
  }

  DrawnBlock paint(std::int64_t col, std::int64_t row) const {
    const BlockGround ground = ground_of_block(mosaic_, transform_, col, row);
    DrawnBlock drawn;
    drawn.raster.pixels = cv::Mat(ground.height, ground.width, CV_8UC3, cv::Scalar(0, 0, 0));
    drawn.raster.valid = cv::Mat(ground.height, ground.width, CV_8U, cv::Scalar(0));
    const cv::Size cells((ground.width + kMapCell_px - 1) / kMapCell_px,
                         (ground.height + kMapCell_px - 1) / kMapCell_px);
    drawn.map_sigma_m = cv::Mat(cells, CV_32F, cv::Scalar(kNaN));
    drawn.cell_frame = drawn.map_sigma_m.clone();
    drawn.cell_frames_seen = drawn.map_sigma_m.clone();
    const std::vector<FrameOverBlock> frames = frames_over(ground);
    if (frames.empty()) return drawn;
    const cv::Mat best = best_frames(frames, ground);
    blend(frames, best, drawn);
    const std::vector<std::size_t> near = frames_near(ground);
    for (int cell_row = 0; cell_row < cells.height; ++cell_row) {
      for (int cell_col = 0; cell_col < cells.width; ++cell_col)
        describe_cell(frames, near, best, ground, cell_col, cell_row, drawn);
    }
    return drawn;
  }

 private:
  /// How far from its nadir a frame sees ground, at most.
  double reach_m(const FramePose& pose) const {
    const Camera& camera = mosaic_.block->camera;
    double farthest_m = 0;
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(camera.width_px, 0), Eigen::Vector2d(0, camera.height_px),
          Eigen::Vector2d(camera.width_px, camera.height_px)}) {
      const auto ray = ray_from_pixel(lens_, corner);
      if (!ray) return std::numeric_limits<double>::infinity();
      const Eigen::Vector3d direction = pose.enu_from_camera * *ray;
      if (direction.z() > -0.05) return std::numeric_limits<double>::infinity();
      const double down_m = pose.center_enu_m.z() - mosaic_.ground->heights.lowest_m();
      farthest_m = std::max(farthest_m, down_m * direction.head<2>().norm() / -direction.z());
    }
    return farthest_m;
  }

  /// From the place below a frame to a block.
  double distance_m(std::size_t frame, const BlockGround& ground) const {
    const Eigen::Vector2d nadir = mosaic_.block->poses[frame].center_enu_m.head<2>();
    return (nadir - nadir.cwiseMax(ground.low_m).cwiseMin(ground.high_m)).norm();
  }

  /// Whether a frame is the nearest somewhere, or near enough to fade into the nearest: of two frames whose nadirs are
  /// a and b away, the band along their seam is where a − b is below twice its width.
  bool counts_somewhere(const FrameOverBlock& over, const cv::Mat& nearest_m2) const {
    const float band_m = static_cast<float>(2 * kFeather_px * mosaic_.gsd_m);
    for (int y = 0; y < nearest_m2.rows; ++y) {
      for (int x = 0; x < nearest_m2.cols; ++x) {
        const float own_m2 = over.off_nadir_m2.at<float>(y, x);
        if (own_m2 != kNotSeen && std::sqrt(own_m2) < std::sqrt(nearest_m2.at<float>(y, x)) + band_m) return true;
      }
    }
    return false;
  }

  /// The nearest first, until no farther one can be the best anywhere, nor fade into it.
  std::vector<FrameOverBlock> frames_over(const BlockGround& ground) const {
    std::vector<std::pair<double, std::size_t>> by_distance;
    for (std::size_t i = 0; i < mosaic_.block->poses.size(); ++i) by_distance.emplace_back(distance_m(i, ground), i);
    std::sort(by_distance.begin(), by_distance.end());
    std::vector<FrameOverBlock> frames;
    cv::Mat nearest_m2(ground.height, ground.width, CV_32F, cv::Scalar(static_cast<double>(kNotSeen)));
    for (const auto& [away_m, frame] : by_distance) {
      double farthest_m2 = 0;
      cv::minMaxLoc(nearest_m2, nullptr, &farthest_m2);
      const double band_m = 4 * kFeather_px * mosaic_.gsd_m;
      if (std::isfinite(farthest_m2) && away_m > std::sqrt(farthest_m2) + band_m) break;
      if (away_m > reaches_m_[frame]) continue;
      auto over = look_from(mosaic_, lens_, ground, frame);
      if (!over || !counts_somewhere(*over, nearest_m2)) continue;
      nearest_m2 = cv::min(nearest_m2, over->off_nadir_m2);
      frames.push_back(std::move(*over));
    }
    return frames;
  }

  static cv::Mat best_frames(const std::vector<FrameOverBlock>& frames, const BlockGround& ground) {
    cv::Mat best(ground.height, ground.width, CV_32S, cv::Scalar(-1));
    cv::Mat least(ground.height, ground.width, CV_32F, cv::Scalar(static_cast<double>(kNotSeen)));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const cv::Mat nearer = frames[i].off_nadir_m2 < least;
      best.setTo(static_cast<double>(i), nearer);
      frames[i].off_nadir_m2.copyTo(least, nearer);
    }
    return best;
  }

  std::vector<std::size_t> frames_near(const BlockGround& ground) const {
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < mosaic_.block->poses.size(); ++i) {
      if (distance_m(i, ground) <= reaches_m_[i]) near.push_back(i);
    }
    return near;
  }

  bool sees(std::size_t frame, const Eigen::Vector3d& place_enu_m) const {
    const FramePose& pose = mosaic_.block->poses[frame];
    const Camera& camera = mosaic_.block->camera;
    const auto pixel = pixel_from_ray(lens_, pose.enu_from_camera.transpose() * (place_enu_m - pose.center_enu_m));
    return pixel && pixel->x() >= 0 && pixel->y() >= 0 && pixel->x() <= camera.width_px &&
           pixel->y() <= camera.height_px;
  }

  /// What stands beside the map for a cell of it.
  void describe_cell(const std::vector<FrameOverBlock>& frames, const std::vector<std::size_t>& near,
                     const cv::Mat& best, const BlockGround& ground, int col, int row, DrawnBlock& drawn) const {
    const cv::Rect cell = cv::Rect(col * kMapCell_px, row * kMapCell_px, kMapCell_px, kMapCell_px) &
                          cv::Rect(0, 0, ground.width, ground.height);
    std::vector<int> pixels(frames.size(), 0);
    for (int y = cell.y; y < cell.br().y; ++y) {
      for (int x = cell.x; x < cell.br().x; ++x) {
        if (const int index = best.at<int>(y, x); index >= 0) ++pixels[static_cast<std::size_t>(index)];
      }
    }
    const auto most = std::max_element(pixels.begin(), pixels.end());
    if (*most == 0) return;
    const std::size_t frame = frames[static_cast<std::size_t>(most - pixels.begin())].frame;
    const auto first = static_cast<std::size_t>(row * kNodes + col);
    const auto& nodes = ground.nodes_enu_m;
    const Eigen::Vector3d middle_m =
        (nodes[first] + nodes[first + 1] + nodes[first + kNodes] + nodes[first + kNodes + 1]) / 4;
    const Eigen::Matrix2d covariance_m2 = map_covariance_m2(*mosaic_.block, *mosaic_.ground, frame, middle_m);
    drawn.map_sigma_m.at<float>(row, col) = static_cast<float>(std::sqrt(covariance_m2.trace() / 2));
    drawn.cell_frame.at<float>(row, col) = static_cast<float>(frame + 1);
    const auto seen = std::count_if(near.begin(), near.end(), [&](std::size_t one) { return sees(one, middle_m); });
    drawn.cell_frames_seen.at<float>(row, col) = static_cast<float>(std::max<std::ptrdiff_t>(1, seen));
  }

  /// How much a frame counts at a pixel of which `best` is the nearest.
  float share_of(const FrameOverBlock& one, const FrameOverBlock& best, float one_m2, float best_m2,
                 const cv::Vec2f& place) const {
    if (one_m2 == kNotSeen) return 0;
    const float edge = edge_share(mosaic_.block->camera, place);
    if (one.frame == best.frame) return edge;
    const double apart_m = std::max(1e-3, (one.nadir_m - best.nadir_m).norm());
    const double beyond_seam_m = static_cast<double>(one_m2 - best_m2) / (2 * apart_m);
    return edge * std::max(0.0F, 1 - static_cast<float>(beyond_seam_m / (kFeather_px * mosaic_.gsd_m)));
  }

  void blend(const std::vector<FrameOverBlock>& frames, const cv::Mat& best, DrawnBlock& drawn) const {
    const Camera& camera = mosaic_.block->camera;
    const Eigen::Vector2f middle(static_cast<float>(camera.width_px) / 2 - 0.5F,
                                 static_cast<float>(camera.height_px) / 2 - 0.5F);
    const float half_diagonal2 = (middle.array() + 0.5F).matrix().squaredNorm();
    cv::Mat sum(best.size(), CV_32FC3, cv::Scalar(0, 0, 0));
    cv::Mat weights(best.size(), CV_32F, cv::Scalar(0));
    for (const FrameOverBlock& one : frames) {
      cv::Mat shares(best.size(), CV_32F, cv::Scalar(0));
      std::int64_t used = 0;
      std::int64_t own = 0;
      for (int y = 0; y < best.rows; ++y) {
        for (int x = 0; x < best.cols; ++x) {
          const int index = best.at<int>(y, x);
          if (index < 0) continue;
          const FrameOverBlock& nearest = frames[static_cast<std::size_t>(index)];
          const float share = share_of(one, nearest, one.off_nadir_m2.at<float>(y, x),
                                       nearest.off_nadir_m2.at<float>(y, x), one.place_px.at<cv::Vec2f>(y, x));
          shares.at<float>(y, x) = share;
          used += share > 0 ? 1 : 0;
          own += nearest.frame == one.frame ? 1 : 0;
        }
      }
      if (used == 0) continue;
      drawn.frame_px.emplace_back(one.frame, own);
      const std::shared_ptr<const cv::Mat> pixels = cache_.get(one.frame);
      cv::Mat colors;
      cv::remap(*pixels, colors, one.place_px, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      for (int y = 0; y < best.rows; ++y) {
        for (int x = 0; x < best.cols; ++x) {
          const float share = shares.at<float>(y, x);
          if (share <= 0) continue;
          const cv::Vec2f& place = one.place_px.at<cv::Vec2f>(y, x);
          const float r2 = (Eigen::Vector2f(place[0], place[1]) - middle).squaredNorm() / half_diagonal2;
          auto& total = sum.at<cv::Vec3f>(y, x);
          for (int channel = 0; channel < 3; ++channel) {
            total[channel] += share * static_cast<float>(colors.at<cv::Vec3b>(y, x)[channel]) *
                              balance_factor(*mosaic_.balance, one.frame, static_cast<std::size_t>(channel), r2);
          }
          weights.at<float>(y, x) += share;
        }
      }
    }
    for (int y = 0; y < best.rows; ++y) {
      for (int x = 0; x < best.cols; ++x) {
        const float weight = weights.at<float>(y, x);
        if (weight <= 0) continue;
        drawn.raster.valid.at<std::uint8_t>(y, x) = 255;
        const cv::Vec3f color = sum.at<cv::Vec3f>(y, x) / weight;
        for (int channel = 0; channel < 3; ++channel) {
          drawn.raster.pixels.at<cv::Vec3b>(y, x)[channel] = cv::saturate_cast<std::uint8_t>(color[channel]);
        }
      }
    }
  }

  const OrthoMosaic& mosaic_;
  FrameCache& cache_;
  Lens lens_;
  CrsTransform transform_;
  std::vector<double> reaches_m_;
};

/// Blocks in the order of a curve that stays in one neighbourhood (G. M. Morton, 1966).
std::vector<std::pair<std::int64_t, std::int64_t>> blocks_by_neighbourhood(std::int64_t columns, std::int64_t rows) {
  std::vector<std::pair<std::int64_t, std::int64_t>> blocks;
  std::int64_t side = 1;
  while (side < std::max(columns, rows)) side *= 2;
  for (std::int64_t code = 0; code < side * side; ++code) {
    std::int64_t column = 0;
    std::int64_t row = 0;
    for (int bit = 0; bit < 31; ++bit) {
      column |= ((code >> (2 * bit)) & 1) << bit;
      row |= ((code >> (2 * bit + 1)) & 1) << bit;
    }
    if (column < columns && row < rows) blocks.emplace_back(column, row);
  }
  return blocks;
}

}  // namespace

Eigen::Vector2d east_north_m(const LocalFrame& frame, GeodeticPoint point) {
  return frame.enu_from_geodetic(point).head<2>();
}

GeodeticPoint point_at(const LocalFrame& frame, const Eigen::Vector2d& en_m) {
  // The ellipsoid lies below the tangent plane: go down until east and north come out again.
  double up_m = 0;
  GeodeticPoint point;
  for (int round = 0; round < 4; ++round) {
    point = frame.geodetic_from_enu({en_m.x(), en_m.y(), up_m});
    up_m = frame.enu_from_geodetic(point).z();
  }
  return point;
}

double convergence_deg(const LocalFrame& frame, GeodeticPoint point) {
  const double apart_deg = unwrap_lon_deg(point.lon_deg, frame.origin().lon_deg) - frame.origin().lon_deg;
  return apart_deg * std::sin(point.lat_deg * kRadPerDeg);
}

std::vector<double> known_values(const cv::Mat& cells) {
  std::vector<double> values;
  for (const float value : cv::Mat_<float>(cells)) {
    if (!std::isnan(value)) values.push_back(static_cast<double>(value));
  }
  return values;
}

MosaicStats draw_mosaic(const OrthoMosaic& mosaic, int threads, const Progress& progress,
                        const std::function<void(std::int64_t col, std::int64_t row, const Raster& block)>& write) {
  FrameCache cache(mosaic, kFrameBytes);
  std::vector<std::unique_ptr<BlockPainter>> painters(static_cast<std::size_t>(thread_count(threads)));
  const auto blocks = blocks_by_neighbourhood((mosaic.width_px + kBlock_px - 1) / kBlock_px,
                                              (mosaic.height_px + kBlock_px - 1) / kBlock_px);
  MosaicStats stats;
  stats.frame_px.assign(mosaic.block->poses.size(), 0);
  stats.map_sigma_m =
      cv::Mat(static_cast<int>((mosaic.height_px + kMapCell_px - 1) / kMapCell_px),
              static_cast<int>((mosaic.width_px + kMapCell_px - 1) / kMapCell_px), CV_32F, cv::Scalar(kNaN));
  stats.cell_frame = stats.map_sigma_m.clone();
  stats.cell_frames_seen = stats.map_sigma_m.clone();
  std::mutex writing;
  std::int64_t done = 0;
  parallel_for(blocks.size(), threads, [&](std::size_t i, int worker) {
    std::unique_ptr<BlockPainter>& painter = painters[static_cast<std::size_t>(worker)];
    if (!painter) painter = std::make_unique<BlockPainter>(mosaic, cache);
    const std::int64_t col = blocks[i].first * kBlock_px;
    const std::int64_t row = blocks[i].second * kBlock_px;
    const DrawnBlock drawn = painter->paint(col, row);
    const std::lock_guard lock(writing);
    write(col, row, drawn.raster);
    stats.valid_px += cv::countNonZero(drawn.raster.valid);
    for (const auto& [frame, count] : drawn.frame_px) stats.frame_px[frame] += count;
    const cv::Rect cells(cv::Point(static_cast<int>(col / kMapCell_px), static_cast<int>(row / kMapCell_px)),
                         drawn.map_sigma_m.size());
    drawn.map_sigma_m.copyTo(stats.map_sigma_m(cells));
    drawn.cell_frame.copyTo(stats.cell_frame(cells));
    drawn.cell_frames_seen.copyTo(stats.cell_frames_seen(cells));
    report_progress(progress, "drawing the orthophoto", ++done, static_cast<std::int64_t>(blocks.size()));
  });
  return stats;
}

MosaicStats write_mosaic(const OutputFile& output, const OrthoMosaic& mosaic,
                         std::vector<std::pair<std::string, std::string>> metadata, int threads,
                         const Progress& progress) {
  PictureSource picture{mosaic.width_px, mosaic.height_px, mosaic.crs, mosaic.map_from_pixel, std::move(metadata), {}};
  MosaicStats stats;
  picture.draw = [&](const auto& write) { stats = draw_mosaic(mosaic, threads, progress, write); };
  write_picture_cog(output, picture, progress);
  if (stats.valid_px == 0) throw DataError("the frames show no ground: the map would be empty");
  return stats;
}

std::optional<std::size_t> shown_frame(const OrthoMosaic& mosaic, const MosaicStats& drawn,
                                       const Eigen::Vector2d& map_m) {
  const Eigen::Array2d cell = (mosaic.map_from_pixel.pixel_from_map(map_m).array() / kMapCell_px).floor();
  if (!(cell >= 0).all() || cell.x() >= drawn.cell_frame.cols || cell.y() >= drawn.cell_frame.rows) return std::nullopt;
  const float number = drawn.cell_frame.at<float>(static_cast<int>(cell.y()), static_cast<int>(cell.x()));
  if (!(number >= 1)) return std::nullopt;
  return static_cast<std::size_t>(number) - 1;
}

}  // namespace pilotage
