#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/mission/selection.h"
#include "pilotage/verdict/quality.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A table of texts for the page.
struct NoteTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// What flights that were flown say of the plan (`pilotage replay`), for the page.
struct ReplayNote {
  std::string file;                       ///< That was read.
  std::optional<double> planned_p;        ///< P of the plan that they were held against.
  std::optional<FlownAgainstPlan> flown;  ///< Nothing where no try was over a tile with a P.
  std::vector<std::string> sentences;
  std::vector<NoteTable> tables;   ///< P against what came of it; legs; tiles to look at again.
  std::vector<std::string> notes;  ///< What was lost, left out or assumed.
};

/// Reads replay.json. Throws DataError when the file cannot be read or is not of a replay.
ReplayNote read_replay_note(const std::filesystem::path& path);

/// Throws DataError when the replay was held against a plan with another P than this selection has.
void refuse_other_replay(const ReplayNote& replay, const Selection& selection);

/// How far a flight may leave its plan (`pilotage envelope`), for the page.
struct EnvelopeNote {
  struct Cell {
    std::string value;  ///< Of the factor.
    std::string p;      ///< "0.55"; "–" without a frame.
    std::string said;   ///< "22 correct and 8 false of 40 frames, 0.384 to 0.707"
    double shade = 0;   ///< P, 0 … 1.
  };
  struct Row {
    std::string title;  ///< Factor and world.
    std::vector<Cell> cells;
  };
  std::string file;
  std::vector<Row> rows;
  std::vector<std::string> sentences;  ///< Margins of the planned height, and what the numbers rest on.
};

/// Reads envelope.json. Throws DataError when the file cannot be read or is not of an envelope.
EnvelopeNote read_envelope_note(const std::filesystem::path& path);

/// Sections of the page.
std::string replay_html(const ReplayNote& note);
std::string envelope_html(const EnvelopeNote& note);

}  // namespace pilotage

#pragma GCC visibility pop
