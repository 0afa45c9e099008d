#include "pilotage/landmark/train_landmarks.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "landmark/landmark_ground.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/label_landmarks.h"
#include "pilotage/landmark/score_landmarks.h"
#include "pilotage/mission/landmark_file.h"

namespace pilotage {
namespace {

using testing::draw_ground;
using testing::error_of;
using testing::GroundThing;
using ::testing::HasSubstr;
using testing::kGroundGsd_m;
using testing::scattered;
using testing::TemporaryFolder;
using testing::write_ground;
using testing::write_things;

constexpr int kGroundSide_px = 720;

/// Quick to train.
TrainOptions quick() {
  TrainOptions options;
  options.copies = 1;
  options.blocks = 2;
  return options;
}

struct Ground {
  explicit Ground(bool discs, double brightness = 90, std::uint64_t seed = 1)
      : things(scattered(5, 5, discs, seed)), picture(draw_ground(things, kGroundSide_px, brightness, seed)) {
    ortho = write_ground(folder / "ortho.tif", picture);
    labels = write_things(folder / "things.geojson", things, discs ? "disc" : "bar");
  }
  std::string chips(const std::string& name = "chips") const {
    LabelOptions options;
    options.labels = {labels};
    label_landmarks({ortho}, options, folder / name, true, 1);
    return (folder / name).string();
  }

  TemporaryFolder folder;
  std::vector<GroundThing> things;
  cv::Mat picture;
  std::string ortho;
  std::string labels;
};

LandmarkScoreOptions score_options(const Ground& ground) {
  LandmarkScoreOptions options;
  options.second_epoch = {ground.ortho};
  options.labels.labels = {ground.labels};
  return options;
}

TEST(TrainLandmarks, DiscsAreFoundOnOtherGroundAndAnotherDate) {
  const Ground learnt(true);
  const TrainedLandmarks trained = train_landmarks({learnt.chips()}, quick(), 0, 1);
  ASSERT_EQ(trained.model.detectors.size(), 1U);
  const auto& [detector, places, quality] = trained.model.detectors[0];
  EXPECT_EQ(detector.filters.size(), 1U) << "discs have no heading";
  EXPECT_EQ(detector.period_deg, 0);
  EXPECT_EQ(places.size(), 25U);
  EXPECT_GT(quality.average_precision, 0.9);
  EXPECT_EQ(quality.recall.of, 25);

  const Ground other(true, 75, 99);  // other places, other light
  const LandmarkScores scores = score_landmarks(trained.model, score_options(other), 0);
  ASSERT_EQ(scores.classes.size(), 1U);
  const ScoredClass& scored = scores.classes[0];
  EXPECT_GT(scored.recall.value(), 0.7);
  EXPECT_GT(scored.average_precision, 0.9);
  EXPECT_LE(scored.false_alarms.count, 2);
  EXPECT_NEAR(scored.false_alarms.area_km2, std::pow(kGroundSide_px * kGroundGsd_m / 1000, 2), 1e-3);
  EXPECT_LT(scored.error_median_m, 2.5);
  EXPECT_GT(scored.sigma_m, scored.sigma_interval_m.low);
  EXPECT_LT(scored.sigma_m, scored.sigma_interval_m.high);
}

TEST(TrainLandmarks, HitsLieOnTheLandmarkAndHaveItsLength) {
  const Ground ground(true);
  const TrainedLandmarks trained = train_landmarks({ground.chips()}, quick(), 0, 1);
  const auto hits = detect_landmarks(trained.model.detectors[0].detector, ground.picture, kGroundGsd_m, 0);
  ASSERT_GE(hits.size(), 20U);
  double east = 0;
  double south = 0;
  double squares_m2 = 0;
  for (const LandmarkHit& hit : hits) {
    const GroundThing* nearest = &ground.things.front();
    for (const GroundThing& thing : ground.things) {
      if ((thing.center_m - hit.center_px * kGroundGsd_m).norm() <
          (nearest->center_m - hit.center_px * kGroundGsd_m).norm()) {
        nearest = &thing;
      }
    }
    const Eigen::Vector2d off_m = hit.center_px * kGroundGsd_m - nearest->center_m;
    EXPECT_LT(off_m.norm(), 5);
    EXPECT_NEAR(hit.length_px * kGroundGsd_m / nearest->length_m, 1, 0.5);
    EXPECT_TRUE(std::isnan(hit.heading_deg));
    east += off_m.x() / static_cast<double>(hits.size());
    south += off_m.y() / static_cast<double>(hits.size());
    squares_m2 += off_m.squaredNorm() / static_cast<double>(hits.size());
  }
  // Cells are some 2.5 m: their middles would lie 1 m off, of both axes together. On average nothing is off.
  EXPECT_NEAR(east, 0, 0.3);
  EXPECT_NEAR(south, 0, 0.3);
  EXPECT_LT(std::sqrt(squares_m2), 0.7);
}

TEST(TrainLandmarksThorough, BarsAreFoundAtTheirHeading) {
  const Ground ground(false);
  const TrainedLandmarks trained = train_landmarks({ground.chips()}, quick(), 0, 1);
  const LandmarkDetector& detector = trained.model.detectors[0].detector;
  EXPECT_EQ(detector.filters.size(), 8U);
  EXPECT_EQ(detector.period_deg, 180);
  EXPECT_GT(trained.model.detectors[0].quality.average_precision, 0.8);
  int right = 0;
  int found = 0;
  for (const LandmarkHit& hit : detect_landmarks(detector, ground.picture, kGroundGsd_m, 0)) {
    for (const GroundThing& thing : ground.things) {
      if ((thing.center_m - hit.center_px * kGroundGsd_m).norm() > 5) continue;
      ++found;
      right += std::abs(std::remainder(thing.heading_deg - hit.heading_deg, 180)) <= 22.5 ? 1 : 0;
    }
  }
  EXPECT_GE(found, 20);
  EXPECT_GE(right, found - 2);
}

TEST(TrainLandmarks, TheSameForAnyNumberOfThreadsAndReadsBack) {
  const Ground ground(true);
  const std::string chips = ground.chips();
  const std::string text = json_text(landmark_model_to_json(train_landmarks({chips}, quick(), 1, 1).model));
  EXPECT_EQ(text, json_text(landmark_model_to_json(train_landmarks({chips}, quick(), 2, 1).model)));
  const auto file = ground.folder / "model.json";
  write_file(file, text, true);
  const LandmarkModel read = read_landmark_model(file);
  EXPECT_EQ(json_text(landmark_model_to_json(read)), text);

  const auto error = [&](const std::string& changed) {
    write_file(file, changed, true);
    return error_of<DataError>([&] { read_landmark_model(file); });
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  EXPECT_THAT(error(replaced("\"disc\"", "\"disk\"")), HasSubstr("was changed after it was written"));
  EXPECT_THROW(
      {
        write_file(file, replaced("\"disc\"", "\"disk\""), true);
        read_landmark_model(file);
      },
      IntegrityError);
  EXPECT_THAT(error(replaced("\"version\": 1", "\"version\": 2")),
              HasSubstr("is of version 2; this program reads version 1"));
  EXPECT_THAT(error("{}"), HasSubstr("holds no landmark model; `pilotage landmark-train` writes one"));

  // A program that writes models itself may err.
  const auto error_with = [&](const std::function<void(nlohmann::ordered_json&)>& change) {
    nlohmann::ordered_json content = nlohmann::ordered_json::parse(text);
    for (const char* own : {"format", "version", "digest"}) content.erase(own);
    change(content["detectors"][0]);
    return error(json_text(digested_json("pilotage landmark model", 1, content)));
  };
  EXPECT_EQ(error_with([](auto&) {}), "");
  EXPECT_THAT(error_with([](auto& detector) { detector["cell_px"] = 7; }),
              HasSubstr("detectors[0]: window_px = 45 is no odd multiple of cell_px = 7"));
  EXPECT_THAT(error_with([](auto& detector) { detector["window_px"] = 55; }),
              HasSubstr("a filter has 3752 numbers, the window asks for"));
  EXPECT_THAT(error_with([](auto& detector) { detector["gsd_m"] = 0; }), HasSubstr("gsd_m = 0 is outside"));
  EXPECT_THAT(error_with([](auto& detector) { detector["filters"][0][0] = "x"; }), HasSubstr("lists of numbers"));
  EXPECT_THAT(error_with([](auto& detector) { detector["filters"] = nlohmann::ordered_json::array(); }),
              HasSubstr("filters are 0"));
}

TEST(TrainLandmarks, OtherClassesAreLearntAsBackground) {
  const Ground discs(true);
  std::vector<GroundThing> things = discs.things;
  for (std::size_t i = 0; i < things.size(); i += 2) {
    things[i].disc = false;
    things[i].width_m = things[i].length_m / 2;
    things[i].heading_deg = 0;
  }
  std::vector<GroundThing> round;
  std::vector<GroundThing> bars;
  for (const GroundThing& thing : things) (thing.disc ? round : bars).push_back(thing);
  const std::string ortho = write_ground(discs.folder / "both.tif", draw_ground(things, kGroundSide_px, 90, 5));
  LabelOptions label;
  label.labels = {write_things(discs.folder / "discs.geojson", round, "disc"),
                  write_things(discs.folder / "bars.geojson", bars, "bar")};
  label_landmarks({ortho}, label, discs.folder / "both", true, 1);
  TrainOptions options = quick();
  options.heading_bins = 1;
  const auto trained = train_landmarks({(discs.folder / "both").string()}, options, 0, 1);
  ASSERT_EQ(trained.model.detectors.size(), 2U);
  LandmarkScoreOptions score;
  score.second_epoch = {ortho};
  score.labels.labels = label.labels;
  for (const ScoredClass& scored : score_landmarks(trained.model, score, 0).classes) {
    EXPECT_LE(scored.false_alarms.count, 1) << scored.class_name;
    EXPECT_GT(scored.recall.value(), 0.7) << scored.class_name;
  }
}

TEST(TrainLandmarksThorough, ALandmarkOnTwoDatesIsOneTrialAndNoBackgroundOfAnotherFolder) {
  const Ground ground(true);
  LabelOptions label;
  label.labels = {ground.labels};
  const std::string later =
      write_ground(ground.folder / "later.tif", draw_ground(ground.things, kGroundSide_px, 80, 7));
  label_landmarks({later}, label, ground.folder / "chips_later", true, 1);
  // A folder that was cut with labels of another class shows discs that nobody labelled there.
  std::vector<GroundThing> beside = ground.things;
  for (GroundThing& thing : beside) thing.center_m.y() += 24;
  label.labels = {write_things(ground.folder / "beside.geojson", beside, "mark")};
  label.unfit = UnfitLabels::kSkip;
  label_landmarks({ground.ortho}, label, ground.folder / "beside", true, 1);
  const auto chips = (ground.folder / "chips_later").string();
  TrainOptions options = quick();
  options.c = 50;  // marks are learnt at any price: they are nothing
  const TrainedLandmarks trained =
      train_landmarks({ground.chips(), chips, (ground.folder / "beside").string()}, options, 0, 1);
  const auto learnt = std::find_if(trained.model.detectors.begin(), trained.model.detectors.end(),
                                   [](const LearntDetector& one) { return one.detector.class_name == "disc"; });
  ASSERT_NE(learnt, trained.model.detectors.end());
  EXPECT_EQ(learnt->quality.recall.of, 25);
  EXPECT_EQ(learnt->places.size(), 25U);
  EXPECT_GE(learnt->quality.recall.count, 20);
  EXPECT_LE(learnt->quality.precision.of - learnt->quality.precision.count, 1);
  EXPECT_THROW(train_landmarks({chips, chips + "/."}, quick(), 0, 1), UsageError);
}

TEST(TrainLandmarks, NamesWhatCannotBeLearnt) {
  const Ground ground(true);
  const std::vector<GroundThing> few(ground.things.begin(), ground.things.begin() + 7);
  LabelOptions label;
  label.labels = {write_things(ground.folder / "few.geojson", few, "disc")};
  label_landmarks({ground.ortho}, label, ground.folder / "few", true, 1);
  EXPECT_THAT(error_of<DataError>([&] { train_landmarks({(ground.folder / "few").string()}, quick(), 0, 1); }),
              HasSubstr("disc: has 7 labelled landmarks of 10 px and more; a detector is trained from 8 on"));

  std::vector<GroundThing> small = ground.things;
  for (GroundThing& thing : small) thing.length_m = 4;
  label.labels = {write_things(ground.folder / "small.geojson", small, "disc")};
  label_landmarks({ground.ortho}, label, ground.folder / "small", true, 1);
  EXPECT_THAT(error_of<DataError>([&] { train_landmarks({(ground.folder / "small").string()}, quick(), 0, 1); }),
              HasSubstr("disc: has 0 labelled landmarks of 10 px and more"));

  EXPECT_THAT(error_of<DataError>([&] { train_landmarks({ground.folder.path().string()}, quick(), 0, 1); }),
              HasSubstr("has no labels.xml; `pilotage landmark-label` writes it"));
  label.labels = {ground.labels};
  label.gsd_m = 1;
  label_landmarks({ground.ortho}, label, ground.folder / "coarse", true, 1);
  EXPECT_THAT(error_of<DataError>([&] {
                train_landmarks({ground.chips(), (ground.folder / "coarse").string()}, quick(), 0, 1);
              }),
              HasSubstr("has pixels of 1 m, other chips of 0.5 m"));
  TrainOptions odd = quick();
  odd.window_px = 50;
  EXPECT_THROW(train_landmarks({ground.chips()}, odd, 0, 1), UsageError);
}

TEST(TrainLandmarks, ADetectorThatNeverFiresIsAnError) {
  const Ground ground(true);
  cv::Mat noise = draw_ground({}, kGroundSide_px, 0, 4);  // the labels are of nothing
  LabelOptions label;
  label.labels = {ground.labels};
  label_landmarks({write_ground(ground.folder / "noise.tif", noise)}, label, ground.folder / "noise", true, 1);
  TrainOptions options = quick();
  options.c = 0.1;
  EXPECT_THAT(error_of<DataError>([&] { train_landmarks({(ground.folder / "noise").string()}, options, 0, 1); }),
              HasSubstr("disc: the detector finds none of the 25 labels that it learnt: they do not look alike"));
}

TEST(ScoreLandmarks, CountsWhatIsMissingAndWhatIsNotALandmark) {
  const Ground ground(true);
  const TrainedLandmarks trained = train_landmarks({ground.chips()}, quick(), 0, 1);
  // Of the 25, five are gone at another date, and three that nobody labelled came.
  std::vector<GroundThing> later(ground.things.begin() + 5, ground.things.end());
  std::vector<GroundThing> labelled = ground.things;
  labelled.push_back(ground.things[0]);
  labelled.back().center_m = {5000, 100};  // not on the imagery
  for (const double at : {90.0, 150.0, 210.0}) {
    GroundThing thing;
    thing.center_m = {at, 345};
    later.push_back(thing);
  }
  LandmarkScoreOptions options;
  options.second_epoch = {write_ground(ground.folder / "later.tif", draw_ground(later, kGroundSide_px, 90, 8))};
  options.labels.labels = {write_things(ground.folder / "labelled.geojson", labelled, "disc")};
  options.search_radius_m = 70;
  const LandmarkScores scores = score_landmarks(trained.model, options, 0);
  const ScoredClass& scored = scores.classes[0];
  EXPECT_EQ(scores.outside, 1);
  EXPECT_EQ(scored.recall.of, 25);
  EXPECT_GE(scored.recall.count, 17);
  EXPECT_LE(scored.recall.count, 20);
  EXPECT_EQ(scored.recall_elsewhere.of, 0) << "all were learnt";
  EXPECT_GE(scored.false_alarms.count, 3);
  EXPECT_LE(scored.false_alarms.count, 5);
  // The first five are those that are gone.
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(scores.landmarks[i].fate, LandmarkFate::kMissed);
  EXPECT_TRUE(scores.landmarks[7].learnt);
  // Neighbours lie some 60 m apart: four in the middle, and what is taken for one on π · 70² m².
  const double false_alarms = scored.false_alarms.value() * 1e-6 * 3.14159265 * 70 * 70;
  EXPECT_NEAR(scores.landmarks[12].ambiguity, 4 * scored.recall.value() + false_alarms, 1.01 * scored.recall.value());
  EXPECT_GT(scores.landmarks[12].ambiguity, scores.landmarks[24].ambiguity);
  // A corner has two.

  // The same for any number of threads.
  const LandmarkScores again = score_landmarks(trained.model, options, 1);
  ASSERT_EQ(again.landmarks.size(), scores.landmarks.size());
  for (std::size_t i = 0; i < again.landmarks.size(); ++i) {
    EXPECT_EQ(again.landmarks[i].place.lon_deg, scores.landmarks[i].place.lon_deg);
  }

  options.labels.class_name = "tree";
  EXPECT_THAT(error_of<DataError>([&] { score_landmarks(trained.model, options, 0); }),
              HasSubstr("no label is of a class that the model knows: disc"));
}

TEST(ScoreLandmarks, ALabelIsFoundOnceWhateverTheThreshold) {
  const Ground ground(true);
  TrainedLandmarks trained = train_landmarks({ground.chips()}, quick(), 0, 1);
  LandmarkDetector& detector = trained.model.detectors[0].detector;
  const auto precision_at = [&](double threshold) {
    detector.threshold = threshold;
    return score_landmarks(trained.model, score_options(ground), 0).classes[0].average_precision;
  };
  const double all = precision_at(-10);
  EXPECT_LE(all, 1);
  EXPECT_DOUBLE_EQ(precision_at(1000), all) << "a threshold has no part in it";
}

TEST(ScoreLandmarks, WhatLiesOnABlocksBorderIsFound) {
  const Ground learnt(true);
  const TrainedLandmarks trained = train_landmarks({learnt.chips()}, quick(), 0, 1);
  const LandmarkDetector& detector = trained.model.detectors[0].detector;
  // Discs along the border of two blocks, some 1024 of the detector's pixels east.
  std::vector<GroundThing> things;
  for (int i = 0; i < 10; ++i) {
    GroundThing thing;
    thing.center_m = Eigen::Vector2d(1024 * detector.gsd_m + 0.3 * (i - 5), 60.0 * (i + 1));
    things.push_back(thing);
  }
  LandmarkScoreOptions options;
  options.second_epoch = {write_ground(learnt.folder / "wide.tif", draw_ground(things, 1400, 90, 3))};
  options.labels.labels = {write_things(learnt.folder / "wide.geojson", things, "disc")};
  const LandmarkScores scores = score_landmarks(trained.model, options, 0);
  EXPECT_GE(scores.classes[0].recall.count, 9);
  const LandmarkScores alone = score_landmarks(trained.model, options, 1);
  ASSERT_EQ(alone.landmarks.size(), scores.landmarks.size());
  for (std::size_t i = 0; i < alone.landmarks.size(); ++i) {
    EXPECT_EQ(alone.landmarks[i].fate, scores.landmarks[i].fate);
    EXPECT_EQ(alone.landmarks[i].place.lon_deg, scores.landmarks[i].place.lon_deg);
  }
}

TEST(ScoreLandmarks, DensityHasThePoissonInterval) {
  const Density none{0, 2};
  EXPECT_EQ(none.value(), 0);
  EXPECT_EQ(none.interval().low, 0);
  EXPECT_NEAR(none.interval().high, 3.6889 / 2, 1e-3);
  const Density ten{10, 1};
  EXPECT_NEAR(ten.interval().low, 4.7954, 1e-3);
  EXPECT_NEAR(ten.interval().high, 18.3904, 1e-3);
}

}  // namespace
}  // namespace pilotage
