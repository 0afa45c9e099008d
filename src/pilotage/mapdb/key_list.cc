#include "pilotage/mapdb/key_list.h"

#include <algorithm>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/mapdb/key_list_text.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mapdb/trusted_signature.h"

namespace pilotage {
namespace {

constexpr std::uintmax_t kMaxKeyListBytes = 64 * 1024;

std::vector<std::string> keys_of(const std::vector<ListedKey>& listed) {
  std::vector<std::string> keys;
  for (const ListedKey& key : listed) keys.push_back(key.key);
  return keys;
}

/// The list of a file, once its signature was checked over the bytes that are parsed.
KeyList read_one(const std::filesystem::path& path, const std::vector<std::string>& root_keys) {
  const TrustedSignature trusted = read_trusted_signature(signature_path_of(path), root_keys);
  const std::string text = read_file(path, kMaxKeyListBytes);
  check_signed_bytes(path.string(), text, trusted);
  return parse_key_list(text, path.string());
}

}  // namespace

std::vector<std::string> KeyList::trusted_keys() const {
  return keys_of(signers);
}

const ListedKey* KeyList::find_signer(const std::string& key_id) const {
  const auto found =
      std::find_if(signers.begin(), signers.end(), [&](const ListedKey& key) { return key.key_id == key_id; });
  return found == signers.end() ? nullptr : &*found;
}

KeyList read_key_lists(const std::vector<std::filesystem::path>& lists, const std::vector<std::string>& root_keys,
                       const KeyListRequirements& required) {
  if (lists.empty()) throw UsageError("key_list is missing: name a key list");
  KeyList list = read_one(lists.front(), root_keys);
  for (std::size_t i = 1; i < lists.size(); ++i) {
    KeyList next = read_one(lists[i], keys_of(list.roots));
    if (next.version <= list.version) {
      throw IntegrityError(lists[i].string() + ": is version " + std::to_string(next.version) +
                           ", and the list before it " + std::to_string(list.version) +
                           ": give the lists from the oldest to the newest");
    }
    list = std::move(next);
  }
  const std::string name = lists.back().string();
  if (list.version < required.min_version) {
    throw IntegrityError(name + ": is version " + std::to_string(list.version) + ", and at least " +
                         std::to_string(required.min_version) + " is asked for: take the latest key list");
  }
  if (required.now && *required.now >= list.valid_until) {
    throw IntegrityError(name + ": expired at " + format_utc_time(list.valid_until) + ", and it is " +
                         format_utc_time(*required.now) + ": take the latest key list");
  }
  return list;
}

}  // namespace pilotage
