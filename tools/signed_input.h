#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command.h"

#include "pilotage/mapdb/key_list.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_signature.h"

namespace pilotage {

/// Whom a command that reads a map trusts to have signed it, and what the map must be for.
struct TrustOptions {
  std::vector<std::string> public_key;
  std::vector<std::string> key_list;
  std::vector<std::string> root_key;
  std::int64_t min_key_list_version = 1;
  std::optional<std::string> signature;
  bool require_signature = false;
  std::optional<std::string> mission;
  std::optional<std::int64_t> min_version;
  std::optional<std::string> now;
  bool allow_expired = false;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("public_key", self.public_key,
                "Check the signature first, before anything is read: a minisign public key, or its file; of several, "
                "one must have signed.");
    fields.path("key_list", self.key_list,
                "The same with the signers of a signed key list; of several, each signed by a root of the one before.");
    fields.path("root_key", self.root_key,
                "Who may sign the (first) key list: a minisign public key, or its file; of several, one must have.");
    fields.field("min_key_list_version", self.min_key_list_version, "Refuse an older key list.",
                 Range{1, static_cast<double>(kMaxKeyListVersion)});
    fields.path("signature", self.signature, "Signature file; the map's name with .minisig appended if not given.");
    fields.field("require_signature", self.require_signature, "Refuse a map without --public-key or --key-list.");
    fields.field("mission", self.mission, "Refuse the map of another mission.");
    fields.field("min_version", self.min_version, "Refuse an older map version.",
                 Range{1, static_cast<double>(kMaxMapVersion)});
    fields.field("now", self.now,
                 "The time at which map and key list must be valid, like 2026-03-01T06:30:00Z; the clock's if not "
                 "given.");
    fields.field("allow_expired", self.allow_expired, "Take a map and a key list that have expired.");
  }
};

/// A map whose signature was checked, and the list that its signer stands in, if a list was given.
struct SignedInput {
  SignedMap map;
  std::optional<KeyList> key_list;
};

/// The map at `path`, checked; nothing when neither key nor key list was given. Throws UsageError for options that are
/// empty or need another, DataError when there is no map; as read_signed_map and read_key_lists.
std::optional<SignedInput> read_signed_input(const TrustOptions& options, const std::string& path);

/// The keys that are trusted, and the list that they stand in, if one was given; no key when nothing was.
struct TrustedKeys {
  std::vector<std::string> keys;
  std::optional<KeyList> list;
};

/// What the options name. Throws UsageError for options that are empty or need another; as read_key_lists.
TrustedKeys checked_keys_of(const TrustOptions& options);

/// Says in text and JSON who signed, and where a key list was given, whom it knows the key for.
void add_signature(const SignatureInfo& signature, const std::optional<KeyList>& key_list, CommandResult& result);

/// A text whose signature was checked, if a key or a key list was given.
struct SignedText {
  std::string text;
  std::optional<SignatureInfo> signature;
  std::optional<KeyList> key_list;
};

/// The file at `path` and its signature beside it (.minisig). Throws UsageError as read_signed_input, and for
/// --signature; IntegrityError when it is not what one of the keys signed; DataError when it cannot be read or has more
/// than `max_bytes`.
SignedText read_signed_text(const TrustOptions& options, const std::filesystem::path& path, std::uintmax_t max_bytes);

/// Why the map would be refused without --allow-expired; nothing when it would not. Throws as requirements_of.
std::optional<std::string> expiry_warning(const MapReader& map, const TrustOptions& options);

/// What check_purpose is to ask of the map, but for the camera. Throws UsageError for a time that is none.
MapRequirements requirements_of(const TrustOptions& options);

}  // namespace pilotage
