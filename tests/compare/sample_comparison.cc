#include "compare/sample_comparison.h"

namespace pilotage::testing {
namespace {

MethodOutcome outcome(double detect_ms, int best_agreeing, int matches_agreeing, int inliers) {
  MethodOutcome result;
  result.frame_features = 100;
  result.reference_features = 700;
  result.detect_ms = detect_ms;
  result.describe_ms = 1;
  result.reference_ms = 50;
  result.match_ms = 2;
  result.matches = 100;
  result.matches_agreeing = matches_agreeing;
  result.best = 10;
  result.best_agreeing = best_agreeing;
  result.candidates = 40;
  result.inliers = inliers;
  return result;
}

MethodOutcome with_fix(MethodOutcome result, double error_m) {
  result.scale = 1;
  result.error_m = error_m;
  result.accepted = true;
  result.correct = error_m < 5;
  return result;
}

}  // namespace

Comparison sample_comparison() {
  Comparison comparison;
  comparison.methods = {DescriptorMethod::kOrb, DescriptorMethod::kSift};
  comparison.gsd_m = 0.6;
  comparison.frames = {{"a.jpg", "", true, {with_fix(outcome(10, 9, 40, 30), 1.5), outcome(100, 5, 20, 3)}},
                       {"b.jpg", "", true, {with_fix(outcome(20, 3, 10, 8), 80), outcome(110, 4, 20, 4)}},
                       {"c.jpg", "", false, {outcome(60, 0, 0, 2), outcome(120, 0, 0, 0)}},
                       {"d.jpg", "The frame shows no ground.", false, {MethodOutcome{}, MethodOutcome{}}}};
  for (const DescriptorMethod method : comparison.methods) {
    comparison.pictures.push_back({method, cv::Mat(40, 60, CV_8UC3, cv::Scalar(10, 20, 30))});
  }
  return comparison;
}

}  // namespace pilotage::testing
