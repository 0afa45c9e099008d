#include "pilotage/report/flight_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

std::filesystem::path note_file(const std::string& text) {
  const std::filesystem::path path = ::testing::TempDir() + "/flight_note.json";
  write_file(path, text, true);
  return path;
}

TEST(EnvelopeNote, IsAHeatMapOfNumbers) {
  const EnvelopeNote note = read_envelope_note(note_file(R"({"pilotage_envelope": 1, "planned_height_m": 121,
    "worlds": ["<b>.tif"], "notes": ["simulated"],
    "cells": [
      {"factor": "planned", "value": null, "world": 0, "frames": 4, "correct": 3, "false": 1, "p_correct": 0.75,
       "p_correct_low": 0.19, "p_correct_high": 0.99},
      {"factor": "height_m", "value": 60, "world": 0, "frames": 0, "correct": 0, "false": 0, "p_correct": null,
       "p_correct_low": 0, "p_correct_high": 1},
      {"factor": "height_m", "value": 80, "world": 0, "frames": 4, "correct": 4, "false": 0, "p_correct": 1,
       "p_correct_low": 0.39, "p_correct_high": 1},
      {"factor": "lens_drops", "value": 30, "world": 0, "frames": 4, "correct": 2, "false": 1, "p_correct": 0.5,
       "p_correct_low": 0.06, "p_correct_high": 0.94, "largest_error_m": 22.4}],
    "height_margins": [{"world": 0, "planned_p_correct": 0.75, "surely_above_half_m": null,
                        "as_good_as_planned_m": [60, 140]}]})"));
  ASSERT_EQ(note.rows.size(), 3U);
  EXPECT_EQ(note.rows[1].cells.size(), 2U);
  EXPECT_EQ(note.rows[1].cells[0].p, "–");
  const std::string html = envelope_html(note);
  EXPECT_THAT(html, HasSubstr("rgba(0,114,178,0.562)\"><b>0.75</b>"));
  EXPECT_THAT(html, HasSubstr("3 correct and 1 false of 4 frames, 0.19 to 0.99"));
  EXPECT_THAT(html, HasSubstr("Drops on the lens, in"));
  EXPECT_THAT(html, HasSubstr("2 correct and 1 false (off by up to 22 m) of 4 frames, 0.06 to 0.94"));
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;.tif"));
  EXPECT_THAT(html,
              HasSubstr("surely above 0.5 not even at the planned height, and at least nine tenths of the planned "
                        "one from 60 to 140 m."));
  EXPECT_THROW(read_envelope_note(note_file(R"({"pilotage_plan": 1})")), DataError);
  EXPECT_THROW(read_envelope_note(note_file(R"({"pilotage_envelope": 1, "worlds": [], "cells": [{"factor": "height_m",
    "world": 0}]})")),
               DataError)
      << "no such world";
}

TEST(ReplayNote, SaysWhatFlightsSayOfThePlan) {
  const ReplayNote note = read_replay_note(note_file(R"({"pilotage_replay": 1,
    "fixes": {"tries": 10, "right": 6, "unjudged": 0, "missed": 3, "not_stored": 0, "off_line": 0, "false_taken": 1},
    "prediction": {"observed": {"count": 6, "of": 10, "rate": 0.6, "low": 0.262, "high": 0.878}, "predicted": 0.9,
      "large_z": -3.2, "large_z_with_level": -1.1,
      "reliability": [{"low_p": 0.8, "high_p": 1, "mean_p": 0.9, "count": 6, "of": 10, "rate": 0.6, "low": 0.262,
                       "high": 0.878}]},
    "median_error_m": 1.5, "p95_error_m": 4,
    "inertial": {"grade": "tactical", "factor": null, "why_not": "too few gaps"},
    "legs": [{"leg": 1, "planned_p": 0.99, "predicted": 0.9,
              "observed": {"count": 0, "of": 0, "rate": null, "low": 0, "high": 1},
              "median_error_m": null, "largest_error_m": null}],
    "contradictions": {"suspects": [{"tile_id": 7, "center_lon_deg": 16.5, "center_lat_deg": 55.5, "p": 0.95,
      "passes": 4, "won": 0, "chance": 0.0001, "refresh": true}]},
    "notes": ["12 bytes hold no record"]})"));
  const std::string html = replay_html(note);
  EXPECT_THAT(html, HasSubstr("6 of 10, 0.600 [0.262, 0.878] came as a fix, 0.900 were predicted; −1.10 standard"));
  EXPECT_THAT(html, HasSubstr("Inertial system (tactical): too few gaps"));
  EXPECT_THAT(html, HasSubstr("Leg 1"));
  EXPECT_THAT(html, HasSubstr("0 of 4"));
  EXPECT_THAT(html, HasSubstr("12 bytes hold no record"));
  EXPECT_THAT(html, HasSubstr("kind measured"));
  EXPECT_THROW(read_replay_note(note_file("[]")), DataError);
}

TEST(ReplayNote, OfAnotherPlanIsRefused) {
  ReplayNote note;
  Selection selection;
  refuse_other_replay(note, selection);
  selection.probability.emplace().p_within_limit = 0.97;
  refuse_other_replay(note, selection);
  note.planned_p = 0.97;
  refuse_other_replay(note, selection);
  note.planned_p = 0.95;
  EXPECT_THROW(refuse_other_replay(note, selection), DataError);
}

}  // namespace
}  // namespace pilotage
