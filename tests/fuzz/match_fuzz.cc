// Any frame, prior, camera and options over a small map: match() gives a status and throws nothing, the same twice, and
// a fix that holds no nonsense.
//
// The input is text: lines "name number", then maybe a line "pixels" and bytes. Names are those of `fields_of` below;
// what is not said keeps the value with which the frame is found. `picture` chooses what the frame shows.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <string_view>

#include "fuzz/fuzz_targets.h"
#include "testing/textured_map.h"
#include <Eigen/LU>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "pilotage/base/text.h"
#include "pilotage/match/match.h"
#include "pilotage/match/mavlink_position.h"
#include "pilotage/match/nav_sat_fix.h"

namespace pilotage {
namespace {

constexpr double kMaxFramePx = 1 << 16;  // larger ones only take longer
constexpr double kMaxSearch = 2e3;
constexpr std::size_t kAskedTwice = 8;  // one question in so many

/// Made once: the ground, its map, and a good frame.
struct Scene {
  testing::TexturedGround ground = small_frames(testing::make_textured_ground());
  cv::Mat frame = testing::frame_over(ground, 5, -4, {30, 2, -1}, ground.agl_m).gray;
  MapReader map = open_map(ground);

  /// The ground with a camera that sees the middle of what its own sees, so that a question takes milliseconds.
  static testing::TexturedGround small_frames(testing::TexturedGround ground) {
    ground.camera = {88, 66, 140, 140, 44, 33};
    return ground;
  }

  static MapReader open_map(const testing::TexturedGround& ground) {
    const auto path =
        std::filesystem::temp_directory_path() / ("pilotage-match-fuzz-" + std::to_string(::getpid()) + ".gpkg");
    testing::write_textured_map(path, ground);
    MapReader reader = MapReader::open_unverified(path);
    std::filesystem::remove(path);  // stays readable while it is open
    return reader;
  }
};

Scene& scene() {
  static Scene made;
  return made;
}

/// What match() is asked.
struct Question {
  MatchPrior prior{scene().ground.center, isotropic_covariance_m2(4), scene().ground.agl_m, {30, 2, -1}};
  double sigma_m = 4;  // of the prior; with the next its covariance
  double shared_m2 = 0;
  Camera camera = scene().ground.camera;
  MatchOptions options;
  double width_px = camera.width_px;
  double height_px = camera.height_px;
  double distortion_model = 0;
  double picture = 0;  // 0 the ground, 1 black, 2 white, 3 the given pixels over and over, 4 colour, 5 16 bits, 6 none
  double chips = 0;
  std::string pixels = "\x10\xf0\x80";
};

std::map<std::string, double*> fields_of(Question& question) {
  MatchPrior& prior = question.prior;
  Camera& camera = question.camera;
  MatchOptions& options = question.options;
  std::map<std::string, double*> fields{{"lon_deg", &prior.position.lon_deg},
                                        {"lat_deg", &prior.position.lat_deg},
                                        {"sigma_m", &question.sigma_m},
                                        {"covariance_en_m2", &question.shared_m2},
                                        {"height_agl_m", &prior.height_agl_m},
                                        {"yaw_deg", &prior.attitude.yaw_deg},
                                        {"pitch_deg", &prior.attitude.pitch_deg},
                                        {"roll_deg", &prior.attitude.roll_deg},
                                        {"fx_px", &camera.fx_px},
                                        {"fy_px", &camera.fy_px},
                                        {"cx_px", &camera.cx_px},
                                        {"cy_px", &camera.cy_px},
                                        {"mount_yaw_deg", &camera.mount.yaw_deg},
                                        {"mount_pitch_deg", &camera.mount.pitch_deg},
                                        {"mount_roll_deg", &camera.mount.roll_deg},
                                        {"width_px", &question.width_px},
                                        {"height_px", &question.height_px},
                                        {"distortion_model", &question.distortion_model},
                                        {"picture", &question.picture},
                                        {"chips", &question.chips}};
  for (std::size_t i = 0; i < camera.distortion.size(); ++i) fields["k" + std::to_string(i)] = &camera.distortion[i];
  fields["search_sigmas"] = &options.search_sigmas;
  fields["attitude_sigma_deg"] = &options.attitude_sigma_deg;
  fields["yaw_sigma_deg"] = &options.yaw_sigma_deg;
  fields["height_sigma_fraction"] = &options.height_sigma_fraction;
  fields["map_sigma_m"] = &options.map_sigma_m.emplace(1);
  fields["max_false_fix_rate"] = &options.max_false_fix_rate;
  fields["max_memory_mib"] = &options.max_memory_mib;
  return fields;
}

Question read_question(const std::string& text) {
  Question question;
  const auto fields = fields_of(question);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && line != "pixels";) {
    const auto blank = line.find(' ');
    const auto field = fields.find(line.substr(0, blank));
    if (field == fields.end() || blank == std::string::npos) continue;
    if (const auto number = parse_number(std::string_view(line).substr(blank + 1))) *field->second = *number;
  }
  if (lines) question.pixels.assign(std::istreambuf_iterator<char>(lines), {});
  if (question.pixels.empty()) question.pixels = "x";
  question.options.chips = question.chips > 0;
  question.prior.covariance_en_m2 = isotropic_covariance_m2(question.sigma_m);
  question.prior.covariance_en_m2(0, 1) = question.prior.covariance_en_m2(1, 0) = question.shared_m2;
  const bool known = question.distortion_model >= 0 && question.distortion_model <= 2;
  question.camera.distortion_model =
      known ? static_cast<DistortionModel>(static_cast<int>(question.distortion_model)) : DistortionModel::kNone;
  return question;
}

/// The frame, and the camera's size set to it unless the question wants them to differ (a negative size).
cv::Mat make_frame(Question& question) {
  const auto side = [](double asked) { return static_cast<int>(std::clamp(std::abs(asked), 1.0, 4096.0)); };
  const int width = side(question.width_px);
  const int height = side(question.height_px);
  if (question.width_px > 0) question.camera.width_px = width;
  if (question.height_px > 0) question.camera.height_px = height;
  if (question.picture == 6 || static_cast<double>(width) * height > kMaxFramePx) return {};
  if (question.picture == 1) return cv::Mat(height, width, CV_8UC1, cv::Scalar(0));
  if (question.picture == 2) return cv::Mat(height, width, CV_8UC1, cv::Scalar(255));
  if (question.picture == 4) return cv::Mat(height, width, CV_8UC3, cv::Scalar::all(90));
  if (question.picture == 5) return cv::Mat(height, width, CV_16UC1, cv::Scalar(9000));
  cv::Mat frame(height, width, CV_8UC1);
  const cv::Mat& ground = scene().frame;
  std::size_t next = 0;
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const auto pixel = static_cast<std::uint8_t>(question.pixels[next++ % question.pixels.size()]);
      frame.at<std::uint8_t>(row, col) =
          question.picture == 3 ? pixel : ground.at<std::uint8_t>(row % ground.rows, col % ground.cols);
    }
  }
  return frame;
}

/// Whether the answer would take long rather than be hard: turns × scales × places that are searched, times the ground
/// that a frame shows, of which a good one shows one.
bool is_long_search(const Question& question) {
  const MatchPrior& prior = question.prior;
  const MatchOptions& options = question.options;
  const double half_width_m = options.search_sigmas * largest_sigma_m(prior.covariance_en_m2) +
                              prior.height_agl_m * options.attitude_sigma_deg / 20;
  const double frame_m =
      prior.height_agl_m * std::abs(question.width_px) / std::min(question.camera.fx_px, question.camera.fy_px);
  const double size_m = std::min(400.0, frame_m);  // of what is laid on the map's grid
  const double ground = std::max(1.0, size_m * size_m / (38 * 38));
  const double turns = options.yaw_sigma_deg * size_m / 100;
  const double scales = 1 + options.height_sigma_fraction * size_m;
  const double ways = options.chips ? 10 : 1;
  return half_width_m * half_width_m * turns * scales * ground * ways > kMaxSearch;
}

bool is_sound(const Fix& fix) {
  const auto is_place = [](const GeodeticPoint& point) {
    return point.lon_deg >= -180 && point.lon_deg <= 180 && point.lat_deg >= -90 && point.lat_deg <= 90;
  };
  const auto is_covariance = [](const Eigen::Matrix2d& m) {
    return m.allFinite() && m(0, 0) > 0 && m(1, 1) > 0 && m.determinant() > 0 &&
           std::abs(m(0, 1) - m(1, 0)) <= 1e-9 * m.trace();
  };
  return is_place(fix.position) && is_place(fix.center) && is_covariance(fix.covariance_en_m2) &&
         is_covariance(fix.center_covariance_en_m2) && std::isfinite(fix.yaw_deg) && std::isfinite(fix.pitch_deg) &&
         std::isfinite(fix.roll_deg) && fix.height_agl_m > 0 && fix.scale > 0;
}

void check_result(const MatchResult& result) {
  require(match_status_name(result.status) != "unknown", "the status has a name");
  require((result.status == MatchStatus::kFix) == result.fix.has_value(), "a fix goes with the status fix");
  require(result.stats.confidence >= 0 && result.stats.confidence <= 1, "confidence is in [0, 1]");
  require(std::isfinite(result.stats.vote_peak) && std::isfinite(result.stats.vote_rival), "votes are finite");
  require(std::isfinite(result.stats.residual_m) && result.stats.inliers >= 0, "residual and inliers are numbers");
  if (result.fix) require(is_sound(*result.fix), "a fix is a place with covariances");
  const bool fixed = result.fix.has_value();
  require((mavlink_global_position_sensor(result, {}, {}).flags == 0) == fixed, "MAVLink says whether there is a fix");
  require((nav_sat_fix(result, {}, 0, "").status == kNavSatStatusFix) == fixed, "ROS says whether there is a fix");
}

MatchResult ask(const cv::Mat& frame, const Question& question) {
  return match(frame, question.prior, question.camera, scene().map, question.options);
}

/// Else all questions would be about frames that are not found.
void require_that_the_good_frame_is_found() {
  Question question;
  const cv::Mat frame = make_frame(question);
  require(ask(frame, question).fix.has_value(), "the good frame is found");
}

}  // namespace

void fuzz_match(const std::uint8_t* data, std::size_t size) {
  [[maybe_unused]] static const bool once = (require_that_the_good_frame_is_found(), true);
  const std::string input(data, data + size);
  Question question = read_question(input);
  if (is_long_search(question)) return;
  const cv::Mat frame = make_frame(question);
  const MatchResult result = ask(frame, question);
  check_result(result);
  if (std::hash<std::string>()(input) % kAskedTwice != 0) return;
  const MatchResult again = ask(frame, question);
  require(again.status == result.status && again.stats.inliers == result.stats.inliers &&
              again.stats.confidence == result.stats.confidence,
          "the same question has the same answer");
}

}  // namespace pilotage
