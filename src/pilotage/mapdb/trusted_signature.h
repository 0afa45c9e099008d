#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/mapdb/minisign_files.h"

namespace pilotage {

/// A signature that one of the trusted keys made, and that key. Its trusted comment is checked; the file that it is of
/// is not yet.
struct TrustedSignature {
  MinisignSignature signature;
  MinisignPublicKey key;
};

/// Reads a signature and checks that it and its trusted comment were made by one of `trusted_keys`: each the path of a
/// minisign public key file, or the key itself (56 base64 characters). Throws UsageError when there is no key, or one
/// is empty, cannot be read or is no key; IntegrityError when none of them made it; DataError when it cannot be read.
TrustedSignature read_trusted_signature(const std::filesystem::path& signature_file,
                                        const std::vector<std::string>& trusted_keys);

/// Throws IntegrityError beginning with `name` unless these are the bytes that were signed.
void check_signed_bytes(const std::string& name, const std::string& bytes, const TrustedSignature& trusted);

/// BLAKE2b-256 of bytes (libsodium; RFC 7693).
std::array<std::uint8_t, 32> blake2b_256(std::string_view bytes);

}  // namespace pilotage
