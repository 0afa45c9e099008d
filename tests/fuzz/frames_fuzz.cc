// Any bytes as frames.csv: DataError, or frames whose numbers lie in their ranges.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "fuzz/fuzz_targets.h"
#include <Eigen/LU>

#include "pilotage/base/error.h"
#include "pilotage/mission/frame_table.h"

namespace pilotage {
namespace {

/// NaN where the table may say nothing.
void require_between(double value, double low, double high, bool may_be_missing) {
  const bool holds = std::isnan(value) ? may_be_missing : value >= low && value <= high;
  if (!holds) std::abort();
}

void check_frames(const FrameTable& table, bool may_be_missing) {
  if (table.frames.empty()) std::abort();
  for (const FrameRecord& frame : table.frames) {
    if (frame.file.empty()) std::abort();
    require_between(frame.prior.lat_deg, -90, 90, may_be_missing);
    require_between(frame.prior.lon_deg, -180, 360, may_be_missing);
    require_between(largest_sigma_m(frame.prior_covariance_en_m2), 0, 1.5e5, may_be_missing);
    if (!(frame.prior_covariance_en_m2.determinant() >= -1e-3 * frame.prior_covariance_en_m2.squaredNorm()) &&
        !may_be_missing) {
      std::abort();
    }
    require_between(frame.height_agl_m, -1000, 100000, may_be_missing);
    for (const double angle_deg : {frame.attitude.yaw_deg, frame.attitude.pitch_deg, frame.attitude.roll_deg}) {
      require_between(angle_deg, -360, 360, may_be_missing);
    }
    for (const auto& truth : {frame.true_nadir, frame.true_center}) {
      if (truth) require_between(truth->lat_deg, -90, 90, false);
      if (truth) require_between(truth->lon_deg, -180, 360, false);
    }
  }
}

}  // namespace

void fuzz_frames(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const auto truth : {FrameTruth::kCenter, FrameTruth::kNadir}) {
    for (const auto required : {FrameColumns::kAll, FrameColumns::kFileOnly}) {
      try {
        check_frames(frame_table_from_csv("fuzz", text, {truth, required}), required == FrameColumns::kFileOnly);
      } catch (const DataError&) {
      }
    }
  }
}

}  // namespace pilotage
