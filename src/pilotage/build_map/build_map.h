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
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/stored_size.h"
#include "pilotage/vision/features.h"

namespace pilotage {

/// What is stored for each matching area.
struct BuildOptions {
  FeatureOptions features;
  KeepFeatures keep_features = KeepFeatures::kAll;
  ChipOptions chips;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    FeatureOptions::describe(self.features, fields);
    fields.field("keep_features", self.keep_features,
                 "Which features are stored: all, or those that the second date does not contradict (stable).");
    ChipOptions::describe(self.chips, fields);
  }
};

struct BuildStats {
  std::int64_t tiles = 0;
  std::int64_t descriptors = 0;
  std::int64_t descriptor_bytes = 0;  ///< Of key points and descriptors.
  std::optional<StableStats> stable;  ///< With keep_features = stable.
  std::int64_t chips = 0;
  std::int64_t chip_bytes = 0;
  std::int64_t bytes = 0;      ///< Of the file.
  std::string content_digest;  ///< 64 hex digits.
};

/// The most that the map database can take with these options on the levels of a plan.
StoredSize stored_size(const BuildOptions& options, const Mission& plan);

/// Writes the onboard map database (schemas/map-database.md) of the selected tiles.
///
/// Scored tiles overlap, stored ground does not: each feature belongs to the selected tile, among those it lies in,
/// whose centre is nearest (the larger of both axis distances; the lower tile_id on a tie), so that every descriptor is
/// stored once and the descriptors of a tile's footprint are found in the tiles that overlap it. Imagery streams in
/// strips; features of a piece of ground do not depend on the selection. Chips, where asked for, are stored once
/// likewise (build_chips.h). The layer `tiles` has one row per selected tile with every score.
///
/// With keep_features = stable, a feature is dropped when `second_date` shows the ground around it and no counterpart
/// (feature_fates.h); a tile in whose window fewer than kLeastFeatures are left keeps the strongest others that it
/// owns, up to so many. The levels' grids are then north-up with square pixels. Chips stay as they are.
///
/// The file appears complete or not at all. The same input gives the same bytes for any number of threads. Throws
/// UsageError for options out of range or keep_features without its second date, DataError when the selection or the
/// scores are not of this plan, or when reading or writing fails; Interrupted.
BuildStats build_map(const std::filesystem::path& path, const Mission& plan, const std::vector<TileScore>& scores,
                     const Selection& selection, const std::vector<InputFile>& inputs,
                     const std::string& software_version, const BuildOptions& options, bool overwrite, int threads = 0,
                     const Progress& progress = {}, const std::optional<SecondDate>& second_date = {});

}  // namespace pilotage
