#include "sign_key_options.h"

#include <cstdint>
#include <cstdlib>

#include "stage_files.h"

namespace pilotage {

SignOptions checked_sign_options(const SignKeyOptions& options) {
  refuse_empty("--sign-key", options.sign_key);
  SignOptions sign;
  sign.chunk_list_above_bytes = static_cast<std::uintmax_t>(options.chunk_list_above_mib * 1024 * 1024);
  if (const char* passphrase = std::getenv("PILOTAGE_KEY_PASSPHRASE")) sign.passphrase = passphrase;
  if (options.sign_key) check_secret_key(*options.sign_key, sign.passphrase);
  return sign;
}

}  // namespace pilotage
