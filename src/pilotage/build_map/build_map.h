#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/build_map/build_chips.h"
#include "pilotage/build_map/stable_features.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/stored_size.h"
#include "pilotage/vision/features.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What is stored for each matching area.
struct BuildOptions {
  FeatureOptions features;
  KeepFeatures keep_features = KeepFeatures::kAll;
  ChipOptions chips;
  std::string landmarks;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    FeatureOptions::describe(self.features, fields);
    fields.field("keep_features", self.keep_features,
                 "Which features are stored: all, or those that the second date does not contradict (stable).");
    ChipOptions::describe(self.chips, fields);
    fields.path("landmarks", self.landmarks,
                "Landmarks and their detectors, as `landmark-score --for-map` writes them: those on the planned ground "
                "are stored.");
  }
};

struct BuildStats {
  std::int64_t tiles = 0;
  std::int64_t descriptors = 0;
  std::int64_t descriptor_bytes = 0;  ///< Of key points and descriptors.
  std::optional<StableStats> stable;  ///< With keep_features = stable.
  std::int64_t chips = 0;
  std::int64_t chip_bytes = 0;
  std::int64_t landmarks = 0;
  std::int64_t detectors = 0;
  std::int64_t bytes = 0;      ///< Of the file.
  std::string content_digest;  ///< 64 hex digits.
};

/// The most that the map database can take with these options on the levels of a ground. Throws as
/// read_map_landmarks.
StoredSize stored_size(const BuildOptions& options, const Ground& ground);

/// Writes the onboard map database (schemas/map-database.md) of a mission's selected tiles: their ground
/// (write_ground), then the flight over it.
///
/// `imagery` is the ground's where it is open already, for this stage and others; `purpose` is what the map says that
/// it is for.
///
/// The file appears complete or not at all. The same input gives the same bytes for any number of threads. Throws
/// UsageError for options out of range or keep_features without its second date, DataError when the selection or the
/// scores are not of this plan, or when reading or writing fails; Interrupted.
BuildStats build_map(const std::filesystem::path& path, const Mission& mission, const std::vector<TileScores>& scores,
                     const Selection& selection, const std::vector<InputFile>& inputs,
                     const std::string& software_version, const BuildOptions& options, bool overwrite, int threads = 0,
                     const Progress& progress = {}, const std::optional<SecondDate>& second_date = {},
                     const GroundImagery* imagery = nullptr, const MapPurpose& purpose = {});

/// The same of a ground that nobody has planned a flight over: a map without route, camera or inputs. An existing file
/// is replaced. Throws as build_map.
BuildStats build_ground_map(const std::filesystem::path& path, const ScoreTable& table,
                            const std::vector<std::int64_t>& tile_ids, const BuildOptions& options, int threads = 0,
                            const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
