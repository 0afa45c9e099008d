#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/mapdb/map_signature.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// One thing that is wrong with a map.
struct MapProblem {
  enum class Kind {
    kDamaged,  ///< The file is not what the specification says.
    kDigest,   ///< A digest does not match what it stands for.
  };
  Kind kind = Kind::kDamaged;
  std::string table;                    ///< "" when it concerns the whole file.
  std::optional<std::int64_t> tile_id;  ///< When it concerns one tile.
  std::string message;                  ///< A sentence that begins with the file's name.
};

struct VerifyReport {
  std::vector<MapProblem> problems;  ///< Empty when the map is as it was written. At most 100 are listed.
  std::int64_t tiles = 0;
  std::int64_t descriptor_rows = 0;
  std::int64_t descriptors = 0;
  std::int64_t chips = 0;
  std::int64_t landmarks = 0;
  std::int64_t bytes = 0;
  std::string content_digest;  ///< Computed, 64 hex digits; "" when the file cannot be read through.

  bool ok() const { return problems.empty(); }
  /// Whether a problem is a digest that does not match, not only damage.
  bool any_wrong_digest() const;
};

/// Checks everything that can be checked without a key: file size and header, version, the digest over all rows of all
/// tables, SQLite's integrity_check, both R-trees against the tiles, geometry against bounds, rows that refer to
/// nothing, lengths and values in blobs, the digest of every descriptor row and chip; and that no journal of another
/// program lies beside the file. Damage is reported, not thrown; throws DataError only when there is no file to read,
/// Interrupted.
///
/// Work is bounded by the file's size: a file whose indices lead in circles is reported as damaged when the steps that
/// a sound one of its size can need are spent.
VerifyReport verify_map(const std::filesystem::path& path, const Progress& progress = {});

/// The same of a map whose signature was checked before (read_signed_map): what a stranger made never gets here. Of one
/// with a list of chunks every chunk is checked first, also those that no table uses; wrong ones are reported as
/// digests.
VerifyReport verify_map(const SignedMap& map, const Progress& progress = {});

/// What a ground program calls before a map flies: throws IntegrityError with the first wrong digest, else DataError
/// with the first damage, else nothing.
void require_intact(const VerifyReport& report);

}  // namespace pilotage

#pragma GCC visibility pop
