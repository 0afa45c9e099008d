#include "pilotage/capture/capture_quality.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/capture/block.h"
#include "pilotage/capture/describe_capture.h"

namespace pilotage {
namespace {

using Limits = CaptureThresholds;

QualityRow row_of(const std::string& name, const std::string& label, double number, const std::string& unit) {
  QualityRow row;
  row.name = name;
  row.label = label;
  row.number = number;
  row.unit = unit;
  row.kind = NumberKind::kMeasured;
  return row;
}

QualityStatus judge_at_most(double number, double good, double marginal) {
  return judge_at_least(-number, -good, -marginal);
}

std::string limits_text(const std::string& word, const std::string& good, const std::string& marginal) {
  return "good " + word + " " + good + ", marginal " + word + " " + marginal;
}

QualityRow frames_row(const CaptureResult& done) {
  const auto used = static_cast<double>(done.frames.size());
  QualityRow row = row_of("frames", "Frames in the map", used / static_cast<double>(done.frames_given), "");
  row.value = std::to_string(done.frames.size()) + " of " + std::to_string(done.frames_given);
  row.threshold = limits_text("from", percent_text(Limits::kFramesGood), percent_text(Limits::kFramesMarginal));
  row.status = judge_at_least(row.number, Limits::kFramesGood, Limits::kFramesMarginal);
  if (row.status != QualityStatus::kGood) {
    row.advice = "What was left out stands below. Frames that show nothing in common with others need more overlap.";
  }
  return row;
}

QualityRow sightings_row(const CaptureResult& done) {
  std::vector<double> sightings;
  for (const CapturedFrame& frame : done.frames) sightings.push_back(frame.sightings);
  QualityRow row = row_of("sightings", "Points that a frame shares with others", quantile(sightings, 0.5), "");
  row.value = number_text(row.number, 0) + " (median), " + number_text(quantile(sightings, 0), 0) + " (fewest)";
  row.threshold =
      limits_text("from", number_text(Limits::kSightingsGood, 0), number_text(Limits::kSightingsMarginal, 0));
  row.status = judge_at_least(row.number, Limits::kSightingsGood, Limits::kSightingsMarginal);
  if (row.status != QualityStatus::kGood) {
    row.advice = "Little texture, blur or little overlap: such ground is hard to match in flight, too.";
  }
  return row;
}

QualityRow fitting_row(const CaptureResult& done) {
  const double share = static_cast<double>(done.sightings) / static_cast<double>(done.sightings_found);
  QualityRow row = row_of("fitting", "Of what frames have in common, fits together", share, "");
  row.value = percent_text(share) + " of " + std::to_string(done.sightings_found);
  row.threshold = limits_text("from", percent_text(Limits::kFittingGood), percent_text(Limits::kFittingMarginal));
  row.status = judge_at_least(share, Limits::kFittingGood, Limits::kFittingMarginal);
  if (row.status != QualityStatus::kGood) {
    row.advice = "A rolling shutter, motion blur, moving things or a lens that the model does not know.";
  }
  return row;
}

QualityRow reprojection_row(const CaptureResult& done) {
  QualityRow row = row_of("reprojection", "Reprojection error (RMS, both axes)", done.reprojection_rms_px, "px");
  row.value = number_text(row.number, 2) + " px";
  row.threshold = limits_text("up to", number_text(Limits::kReprojectionGood_px, 0),
                              number_text(Limits::kReprojectionMarginal_px, 0) + " px");
  row.status = judge_at_most(row.number, Limits::kReprojectionGood_px, Limits::kReprojectionMarginal_px);
  if (row.status != QualityStatus::kGood) row.advice = "The camera's model does not describe these frames well.";
  return row;
}

QualityRow focal_length_row(const CaptureResult& done) {
  const double change = std::abs(done.camera.fx_px / done.given_focal_length_px - 1);
  QualityRow row = row_of("focal_length", "Focal length against " + done.camera_source, change, "");
  row.value = number_text(done.camera.fx_px, 1) + " px, " + number_text(100 * change, 1) + " % off";
  row.threshold = limits_text("up to", number_text(100 * Limits::kFocalChangeGood, 0),
                              number_text(100 * Limits::kFocalChangeMarginal, 0) + " %");
  row.status = judge_at_most(change, Limits::kFocalChangeGood, Limits::kFocalChangeMarginal);
  if (done.frames.size() < kFewFrames) {
    row.value += ", held to " + number_text(100 * kHeldSigma, 0) + " %";
    row.kind = NumberKind::kStated;
    row.status = std::max(row.status, QualityStatus::kMarginal);
    row.advice = "Fewer than " + std::to_string(kFewFrames) +
                 " frames do not tell a focal length from a height: give a calibrated camera.";
  } else if (row.status != QualityStatus::kGood) {
    row.advice = "Tags often mislead; a wrong height would look the same.";
  }
  return row;
}

QualityRow positions_row(const CaptureResult& done) {
  QualityRow row = row_of("positions", "Frames' positions against the pictures, without what all miss alike",
                          done.position_ratio, "");
  row.value = number_text(done.position_ratio, 2) + " times what is stated (RMS; " +
              number_text(done.position_rms_m / std::sqrt(2.0), 2) + " m, each axis)";
  row.threshold = limits_text("up to", number_text(Limits::kPositionRatioGood, 1) + " times",
                              number_text(Limits::kPositionRatioMarginal, 0) + " times what is stated");
  row.status = judge_at_most(done.position_ratio, Limits::kPositionRatioGood, Limits::kPositionRatioMarginal);
  if (done.contradicted_positions > 0) {
    row.value += "; " + std::to_string(done.contradicted_positions) + " that contradict the pictures not counted";
    row.status = std::max(row.status, QualityStatus::kMarginal);
  }
  if (row.status != QualityStatus::kGood) {
    row.advice =
        "Positions are worse than stated: the map may lie farther off than it says (--position-sigma-m, "
        "--position-bias-sigma-m).";
  }
  return row;
}

QualityRow overlap_row(const CaptureResult& done) {
  QualityRow row = row_of("overlap", "Of the map, seen by three frames or more", done.seen_by_three, "");
  row.kind = NumberKind::kModelled;  // by the frames as adjusted
  row.value = percent_text(done.seen_by_three) + "; " + number_text(done.frames_seen_median, 0) + " frames (median)";
  row.threshold =
      limits_text("from", percent_text(Limits::kSeenByThreeGood), percent_text(Limits::kSeenByThreeMarginal));
  row.status = judge_at_least(row.number, Limits::kSeenByThreeGood, Limits::kSeenByThreeMarginal);
  if (row.status != QualityStatus::kGood)
    row.advice = "Where fewer than three frames see the ground little checks it: fly lines closer.";
  return row;
}

QualityRow relief_row(const CaptureResult& done) {
  QualityRow row = row_of("relief", "Relief that the ground leaves out (robust)", done.ground_spread_m, "m");
  row.value = number_text(row.number, 2) + " m from " + done.ground;
  row.threshold =
      limits_text("up to", number_text(Limits::kReliefGood_m, 0), number_text(Limits::kReliefMarginal_m, 0) + " m");
  row.status = judge_at_most(row.number, Limits::kReliefGood_m, Limits::kReliefMarginal_m);
  if (row.status != QualityStatus::kGood) {
    row.advice = "What stands out of the ground leans away from the camera: give --elevation, or fly higher.";
  }
  return row;
}

QualityRow georeference_row(const CaptureResult& done) {
  QualityRow row = row_of("georeference", "What its place on the ground rests on", done.map_sigma_median_m, "m");
  row.kind = NumberKind::kModelled;
  row.threshold = "good on " + std::to_string(Limits::kControlPointsGood) + " control points or another map good to " +
                  number_text(Limits::kReferenceGood_m, 0) + " m, marginal on less, or on frames' positions alone";
  row.status = QualityStatus::kMarginal;
  const std::string sigma = "; one standard deviation " + number_text(done.map_sigma_median_m, 2) + " m, each axis";
  const std::string control_text =
      std::to_string(done.control_points) + " control points (" + number_text(done.control_rms_m, 2) + " m RMS)";
  if (done.control_points >= Limits::kControlPointsGood) {
    row.value = control_text + sigma;
    row.status = QualityStatus::kGood;
  } else if (done.alignment) {
    const MapAlignment& alignment = *done.alignment;
    row.value = "another map (" + std::to_string(alignment.ties) + " ties)" + sigma;
    if (alignment.counted_sigma_m > Limits::kReferenceGood_m) {
      row.advice = "The other map is hardly better known than frames' positions: give --control-points.";
    } else if (alignment.ties < Limits::kTiesGood) {
      row.advice = "So few ties hold one corner: give a finer --registration-gsd-m, or --control-points.";
    } else if (alignment.after.verdict == AuditVerdict::kNotKnown || is_farther(alignment)) {
      row.advice = "The map does not lie better on the other one than before: look at the shifts below.";
    } else {
      row.status = QualityStatus::kGood;
    }
  } else if (done.control_points > 0) {
    row.value = control_text + sigma;
    row.advice = "So few control points do not check each other: give four or more.";
  } else {
    row.value = "frames' positions alone" + sigma;
    row.advice =
        "Nothing checks what all positions miss alike: give --control-points, or --align to a map that is known.";
  }
  return row;
}

QualityRow controls_row(const CaptureResult& done) {
  QualityRow row = row_of("control_points", "Control points against their marks (RMS)", done.control_rms_m, "m");
  const double stated_m = std::hypot(done.control_sigma_m, done.gsd_m);  // a mark is good to a pixel
  const double ratio = done.control_rms_m / stated_m;
  row.value = number_text(done.control_rms_m, 3) + " m over " + std::to_string(done.control_points) + ", " +
              number_text(ratio, 1) + " times what is stated";
  row.threshold = limits_text("up to", number_text(Limits::kControlRatioGood, 0) + " times",
                              number_text(Limits::kControlRatioMarginal, 0) +
                                  " times what is stated of them (--control-sigma-m) and a pixel of the map");
  row.status = judge_at_most(ratio, Limits::kControlRatioGood, Limits::kControlRatioMarginal);
  if (row.status != QualityStatus::kGood) {
    row.advice = "Points or their marks are worse than stated: look at the marks, the CRS and the heights.";
  }
  return row;
}

QualityRow checks_row(const CaptureResult& done) {
  QualityRow row = row_of("check_points", "Check points against the map (RMS, each axis)", done.check_rms_m, "m");
  row.value = number_text(done.check_rms_m, 2) + " m over " + std::to_string(done.check_points.size()) + ", " +
              number_text(done.check_ratio, 1) + " times what the map says";
  row.threshold = limits_text("up to", number_text(Limits::kCheckRatioGood, 0) + " times",
                              number_text(Limits::kCheckRatioMarginal, 0) + " times what the map says of itself");
  row.status = judge_at_most(done.check_ratio, Limits::kCheckRatioGood, Limits::kCheckRatioMarginal);
  if (row.status != QualityStatus::kGood)
    row.advice = "The map is worse than it says: what was stated of positions is too good.";
  return row;
}

}  // namespace

std::vector<QualityRow> capture_quality(const CaptureResult& done) {
  std::vector<QualityRow> rows{georeference_row(done)};
  if (done.control_points > 0) rows.push_back(controls_row(done));
  if (!done.check_points.empty()) rows.push_back(checks_row(done));
  for (const auto& row : {frames_row(done), sightings_row(done), fitting_row(done), reprojection_row(done),
                          focal_length_row(done), positions_row(done), overlap_row(done), relief_row(done)}) {
    rows.push_back(row);
  }
  return rows;
}

}  // namespace pilotage
