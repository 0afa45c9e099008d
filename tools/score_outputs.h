#pragma once

#include <optional>
#include <string>

#include "command.h"

#include "pilotage/base/output_file.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/evaluate/evaluation_files.h"
#include "pilotage/mission/frame_table.h"
#include "pilotage/score/score_run.h"

namespace pilotage {

/// What is made of scores, by `score` and, from the scores of its shards, by `merge`.
struct ScoreOutputOptions {
  std::string table;
  std::string second_epoch_output;
  int level = 0;
  EvaluateOptions evaluate;
  CameraOptions camera;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("table", self.table, "Also write the scores as a table (CSV), one line per tile.");
    fields.path("second_epoch_output", self.second_epoch_output,
                "Also write the disagreement of both dates' georeferences as a raster (GeoTIFF).");
    fields.field("level", self.level, "Level of a plan that the raster shows; the table has all.", Range{0, 30});
    fields.group("evaluate", self.evaluate, "What the scores are worth, held against another date or real frames.");
    fields.group("camera", self.camera, "The camera of --evaluate-frames; without it the plan's.");
  }
};

/// The output files of a run: what can be refused is refused when this is made, before the work is done; all appear
/// when it is, or none.
class ScoreOutputs {
 public:
  /// Throws DataError when an output exists and may not be replaced, or an input cannot be read; UsageError for options
  /// that do not fit the run. All three must outlive this.
  ScoreOutputs(const ScoreOutputOptions& options, const Invocation& invocation, const ScoreRun& run);

  /// Writes everything and says what there is to say; `ground` is the run's with all its tiles.
  CommandResult write(const Ground& ground, const GroundScores& scored);

 private:
  void add_evaluation(const ScoreTable& table, const GroundScores& scored, CommandResult& result);

  const ScoreOutputOptions& options_;
  const Invocation& invocation_;
  const ScoreRun& run_;
  std::optional<OutputFile> table_;
  std::optional<OutputFile> style_;
  std::optional<EvaluationFiles> evaluation_;
  std::vector<std::string> second_date_warnings_;
  FrameTable frames_;
};

}  // namespace pilotage
