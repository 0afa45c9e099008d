#include "drawn_flight.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "testing/pinhole_camera.h"
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/camera/lens.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gdal_write.h"
#include "pilotage/raster/map_sigma.h"

namespace pilotage::testing {
namespace {

constexpr int kWidth_px = 1000;
constexpr int kHeight_px = 900;
constexpr double kGsd_m = 0.25;

/// Noise of several sizes, as fields, paths and bushes have.
cv::Mat texture() {
  Random random(7);
  cv::Mat sum(kHeight_px, kWidth_px, CV_32F, cv::Scalar(0));
  for (const int size_px : {2, 4, 9, 25, 70}) {
    cv::Mat coarse(kHeight_px / size_px + 2, kWidth_px / size_px + 2, CV_32F);
    for (float& value : cv::Mat_<float>(coarse)) value = static_cast<float>(random.normal());
    cv::Mat fine;
    cv::resize(coarse, fine, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += fine;
  }
  cv::Mat gray;
  sum.convertTo(gray, CV_8U, 18, 128);
  return gray;
}

}  // namespace

double height_of_ground_m(const Eigen::Vector2d& en_m, double hill_m) {
  return hill_m * std::exp(-en_m.squaredNorm() / (2 * 40.0 * 40.0));
}

std::filesystem::path write_control_points(const std::filesystem::path& folder, const DrawnFlight& flight,
                                           const std::vector<Eigen::Vector2d>& points_en_m, double hill_m,
                                           double moved_m) {
  std::ofstream list(folder / "gcp_list.txt");
  list << "WGS84 UTM 33N\n";
  const CrsTransform transform(flight.crs);
  const Lens lens = make_lens(flight.camera);
  const Eigen::Vector2d middle = flight.ground.map_from_pixel.map_from_pixel({kWidth_px / 2.0, kHeight_px / 2.0});
  for (const Eigen::Vector2d& en_m : points_en_m) {
    const Eigen::Vector2d map = middle + en_m;
    const double height_m = height_of_ground_m(en_m, hill_m);
    const double stated_x = map.x() + (&en_m == &points_en_m.back() ? moved_m : 0);
    for (const DrawnFrame& frame : flight.frames) {
      const Eigen::Vector2d from_nadir_m = map - *transform.map_from_geodetic(frame.nadir);
      const Eigen::Matrix3d enu_from_cam = enu_from_camera({}, {frame.yaw_deg, frame.pitch_deg, frame.roll_deg});
      const auto pixel =
          pixel_from_ray(lens, enu_from_cam.transpose() *
                                   Eigen::Vector3d(from_nadir_m.x(), from_nadir_m.y(), height_m - frame.height_m));
      if (!pixel || pixel->minCoeff() < 5 || pixel->x() > flight.camera.width_px - 5 ||
          pixel->y() > flight.camera.height_px - 5) {
        continue;
      }
      list << format_fixed(stated_x, 3) << " " << format_fixed(map.y(), 3) << " " << format_fixed(height_m, 3) << " "
           << format_fixed(pixel->x(), 2) << " " << format_fixed(pixel->y(), 2) << " " << frame.file << "\n";
    }
  }
  return folder / "gcp_list.txt";
}

DrawnFlight draw_flight(const std::filesystem::path& folder, double hill_m, double position_sigma_m) {
  DrawnFlight flight;
  flight.ground = {texture(), cv::Mat(kHeight_px, kWidth_px, CV_8U, cv::Scalar(255)),
                   GeoTransform::north_up(500000, 5500000, kGsd_m)};
  flight.crs = Crs::from_user_input("EPSG:32633");
  flight.camera = pinhole_camera(480, 360, 400);
  GraySource source = gray_source_from(flight.ground);
  source.crs = flight.crs;
  const CrsTransform transform(flight.crs);
  Random random(3);
  const Eigen::Vector2d middle_px(kWidth_px / 2.0, kHeight_px / 2.0);
  for (int line = 0; line < 4; ++line) {
    for (int along = 0; along < 5; ++along) {
      const int step = line % 2 == 0 ? along : 4 - along;
      const Eigen::Vector2d nadir_px = middle_px + Eigen::Vector2d((step - 2) * 22, (line - 1.5) * 22) / kGsd_m;
      const GroundPlace place = ground_place(flight.crs, flight.ground.map_from_pixel, nadir_px);
      DrawnFrame frame;
      frame.file = "frame" + std::to_string(flight.frames.size() + 1) + ".png";
      frame.nadir = geodetic_from_pixel(transform, flight.ground.map_from_pixel, nadir_px);
      frame.height_m = 60 + random.uniform(-1, 1);
      frame.yaw_deg = (line % 2 == 0 ? 90 : -90) + random.uniform(-4, 4);
      frame.pitch_deg = random.uniform(-3, 3);
      frame.roll_deg = random.uniform(-3, 3);
      const Attitude attitude{frame.yaw_deg, frame.pitch_deg, frame.roll_deg};
      const Eigen::Vector2d from_middle_m = (nadir_px - middle_px).cwiseProduct(Eigen::Vector2d(kGsd_m, -kGsd_m));
      const double below_m = height_of_ground_m(from_middle_m, hill_m);
      constexpr int kNodes = 81;
      std::vector<double> heights_m;
      for (int row = 0; row < kNodes; ++row) {
        for (int column = 0; column < kNodes; ++column) {
          const Eigen::Vector2d en_m(-80 + 2.0 * column, -80 + 2.0 * row);
          heights_m.push_back(height_of_ground_m(from_middle_m + en_m, hill_m) - below_m);
        }
      }
      const RenderedFrame seen = render_terrain_frame(source, place, flight.camera, attitude, frame.height_m - below_m,
                                                      TerrainHeights({-80, -80}, 2, kNodes, heights_m));
      cv::imwrite((folder / frame.file).string(), seen.gray);
      const Eigen::Vector2d error_px = Eigen::Vector2d(random.normal(), random.normal()) * position_sigma_m / kGsd_m;
      frame.stated = geodetic_from_pixel(transform, flight.ground.map_from_pixel, nadir_px + error_px);
      flight.frames.push_back(frame);
    }
  }
  return flight;
}

std::filesystem::path write_ground(const std::filesystem::path& map, const DrawnFlight& flight, double east_m) {
  const Raster& ground = flight.ground;
  GeoTransform place = ground.map_from_pixel;
  place.origin_x += east_m;
  PictureSource picture{ground.pixels.cols, ground.pixels.rows, flight.crs, place, {}, {}};
  picture.draw = [&](const auto& write) {
    Raster all = ground;
    cv::cvtColor(ground.pixels, all.pixels, cv::COLOR_GRAY2RGB);
    write(0, 0, all);
  };
  OutputFile output(map, true);
  write_picture_cog(output, picture);
  output.commit();
  return map;
}

std::filesystem::path write_table(const std::filesystem::path& folder, const std::vector<DrawnFrame>& frames,
                                  bool with_attitude) {
  std::ofstream table(folder / "frames.csv");
  table << "file,time_s,prior_lon_deg,prior_lat_deg,height_agl_m,yaw_deg,pitch_deg,roll_deg\n";
  double time_s = 0;
  for (const DrawnFrame& frame : frames) {
    table << frame.file << "," << time_s << "," << format_fixed(frame.stated.lon_deg, 9) << ","
          << format_fixed(frame.stated.lat_deg, 9) << "," << format_fixed(frame.height_m, 3);
    if (with_attitude) {
      table << "," << frame.yaw_deg << "," << frame.pitch_deg << "," << frame.roll_deg << "\n";
    } else {
      table << ",,,\n";
    }
    time_s += 4;
  }
  return folder / "frames.csv";
}

CaptureOptions options_of(const DrawnFlight& flight) {
  CaptureOptions options;
  options.camera.width_px = flight.camera.width_px;
  options.camera.height_px = flight.camera.height_px;
  options.camera.hfov_deg = 2 * std::atan(flight.camera.width_px / 2.0 / flight.camera.fx_px) * 180 / M_PI;
  options.position_sigma_m = 0.3;
  options.height_sigma_m = 1;
  return options;
}

CaptureResult capture_to(const std::filesystem::path& map, const std::filesystem::path& table,
                         const CaptureOptions& options, int threads) {
  OutputFile output(map, true);
  OutputFile map_sigma(map_sigma_path(map), true);
  CaptureResult done = capture({table.string()}, options, output, map_sigma, threads);
  map_sigma.commit();
  output.commit();
  return done;
}

double worst_frame_m(const DrawnFlight& flight, const CaptureResult& done) {
  double worst_m = 0;
  for (std::size_t i = 0; i < done.frames.size(); ++i) {
    worst_m = std::max(worst_m, geodesic_between(done.frames[i].adjusted, flight.frames[i].nadir).length_m);
  }
  return worst_m;
}

std::vector<double> misplacements_m(const DrawnFlight& flight, const std::filesystem::path& map) {
  const GraySource captured = open_gray_on_grid({map.string()}, flight.crs, flight.ground.map_from_pixel,
                                                flight.ground.pixels.cols, flight.ground.pixels.rows);
  const Raster made = captured.read({0, 0, flight.ground.pixels.cols, flight.ground.pixels.rows});
  constexpr int kPatch = 40;
  constexpr int kReach = 12;
  std::vector<double> misses_m;
  for (int row = kReach; row + kPatch + kReach < made.pixels.rows; row += kPatch) {
    for (int col = kReach; col + kPatch + kReach < made.pixels.cols; col += kPatch) {
      const cv::Rect around(col - kReach, row - kReach, kPatch + 2 * kReach, kPatch + 2 * kReach);
      if (cv::countNonZero(made.valid(around)) < around.area()) continue;
      cv::Mat surface;
      cv::matchTemplate(made.pixels(around), flight.ground.pixels(cv::Rect(col, row, kPatch, kPatch)), surface,
                        cv::TM_CCOEFF_NORMED);
      cv::Point best;
      cv::minMaxLoc(surface, nullptr, nullptr, nullptr, &best);
      misses_m.push_back(std::hypot(best.x - kReach, best.y - kReach) * kGsd_m);
    }
  }
  return misses_m;
}

}  // namespace pilotage::testing
