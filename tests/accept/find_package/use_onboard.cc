#include <cstdio>

#include <opencv2/core.hpp>
#include <pilotage/onboard.h>

// use_onboard MAP NOT_A_MAP: reads every descriptor of a map, asks for a fix on ground it does not hold, and is told
// what is wrong with a file that is no map.
int main(int, char** argv) {
  pilotage::MapReader map = pilotage::MapReader::open_unverified(argv[1]);
  std::size_t descriptors = 0;
  for (const pilotage::MapTile& tile : map.tiles()) {
    if (const auto found = map.descriptors(tile.tile_id, tile.level)) descriptors += found->features.size();
  }
  pilotage::Camera camera;
  camera.width_px = camera.height_px = 64;
  camera.fx_px = camera.fy_px = 64;
  camera.cx_px = camera.cy_px = 32;
  pilotage::MatchPrior prior;
  prior.position = {-120, -45};
  prior.covariance_en_m2 = pilotage::isotropic_covariance_m2(10);
  prior.height_agl_m = 100;
  const auto result = pilotage::match(cv::Mat(64, 64, CV_8UC1, cv::Scalar(0)), prior, camera, map);
  std::printf("Pilotage %s: %zu descriptors, %s\n", PILOTAGE_VERSION, descriptors,
              std::string(pilotage::match_status_name(result.status)).c_str());
  try {
    pilotage::MapReader none = pilotage::MapReader::open_unverified(argv[2]);
    return 1;
  } catch (const pilotage::DataError& error) {
    std::puts(error.what());
  }
  return descriptors > 0 && result.status == pilotage::MatchStatus::kNoMap ? 0 : 1;
}
