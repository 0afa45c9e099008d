#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/utc_time.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A key of a key list.
struct ListedKey {
  std::string key;     ///< A minisign public key, 56 base64 characters.
  std::string key_id;  ///< 16 hex digits, as minisign prints it.
  std::string name;    ///< Whose it is, for people; 1 to 100 bytes.
};

/// Who may sign maps, as those who hold the root keys said it (schemas/key-list.md).
struct KeyList {
  std::int64_t version = 0;  ///< From 1; each list that replaces another has a larger one.
  UtcTime valid_until;
  std::vector<ListedKey> roots;    ///< One of these signs the list that replaces this one.
  std::vector<ListedKey> signers;  ///< One of these signs a map.

  /// The keys of the signers, for MapReader::open.
  std::vector<std::string> trusted_keys() const;
  /// The signer with this id, or nullptr.
  const ListedKey* find_signer(const std::string& key_id) const;
};

inline constexpr std::int64_t kMaxKeyListVersion = 2147483647;

/// What whoever reads a list asks of it.
struct KeyListRequirements {
  /// The highest version that has been seen; who keeps it cannot be given an old list again, with keys that a newer one
  /// no longer trusts.
  std::int64_t min_version = 1;
  /// The time by a clock that may be trusted. Nothing on an aircraft without such a clock: a list that has expired is
  /// then taken.
  std::optional<UtcTime> now;
};

/// Reads the list that holds: the last of `lists`, each of which is signed (LIST.minisig, minisign's format). The first
/// must be signed by one of `root_keys` (as for read_signed_map), each further one by a root of the list before it, and
/// have a higher version. So a list alone is enough as long as the roots are the same; who holds the keys of an old
/// root gives the lists in between, too. Only the last list is held to `required`.
///
/// Throws UsageError when there is no list or root key, or a root key cannot be read; IntegrityError when a signature
/// does not match, a version is too low or the list has expired; DataError when a list or signature cannot be read or
/// is none.
KeyList read_key_lists(const std::vector<std::filesystem::path>& lists, const std::vector<std::string>& root_keys,
                       const KeyListRequirements& required = {});

}  // namespace pilotage

#pragma GCC visibility pop
