#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/score/score_run.h"

namespace pilotage {

/// What a run is, so that two machines can tell that theirs is the same: program, inputs, seed, options, and of every
/// file its name, size and fingerprint (BLAKE2b-256 of the whole file up to 256 KiB, else of 16 pieces of 16 KiB spread
/// evenly over it), and a digest of 64 windows of gray values of each level, which also sees what lies behind a VRT or
/// a URL. Cheap for imagery of any size; what it cannot see is a change inside a large file that leaves its size and
/// all these places as they were. Throws DataError when something cannot be read.
nlohmann::ordered_json describe_run(const ScoreRun& run, const std::string& software_version,
                                    const Progress& progress = {});

/// The run that a description is of, opened again. Throws DataError for a description that is none, naming `name`, and
/// as open_score_run.
ScoreRun open_described_run(const std::string& name, const nlohmann::ordered_json& description);

/// Where two descriptions differ, in words for a message ("options.stride_px: 64, not 32"); "" when they are equal.
std::string run_difference(const nlohmann::ordered_json& run, const nlohmann::ordered_json& other);

}  // namespace pilotage
