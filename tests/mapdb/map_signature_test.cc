#include "pilotage/mapdb/map_signature.h"

#include <cstdlib>

#include "testing/key_pair.h"
#include "testing/overwrite.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_signing.h"
#include "pilotage/mapdb/minisign_secret_key.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Seconds and a gigabyte are minisign's choice; the tests use less.
constexpr testing::ScryptCost kCheap{524288, 16777216};

class MapSignature : public ::testing::Test {
 protected:
  MapSignature() : file_(folder_ / "map.gpkg"), secret_(folder_ / "a.key"), public_(folder_ / "a.pub") {
    write_file(file_, "the bytes of a map", false);
    key_ = testing::generate_key_pair(secret_, public_);
  }

  bool minisign(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.path().string() + "' && minisign " + arguments + " >/dev/null 2>&1";
    return std::system(command.c_str()) == 0;
  }
  static bool has_minisign() { return std::system("minisign -v >/dev/null 2>&1") == 0; }

  testing::TemporaryFolder folder_;
  std::filesystem::path file_;
  std::filesystem::path secret_;
  std::filesystem::path public_;
  std::string key_;
};

TEST_F(MapSignature, SignsAndVerifies) {
  EXPECT_EQ(sign_file(file_, secret_).signature, folder_ / "map.gpkg.minisig");
  const SignatureInfo info = read_signed_map(file_, {public_.string()}).signature();
  EXPECT_TRUE(info.prehashed);
  EXPECT_EQ(info.trusted_comment, "file:map.gpkg\thashed");
  EXPECT_EQ(read_signed_map(file_, {key_}).signature().key_id, info.key_id);
  EXPECT_THROW(sign_file(file_, secret_), DataError) << "a signature is not replaced unless told";
  SignOptions options;
  options.overwrite = true;
  options.trusted_comment = "mission 7";
  const std::string first = read_file(sign_file(file_, secret_, options).signature);
  EXPECT_EQ(read_file(sign_file(file_, secret_, options).signature), first);
  EXPECT_EQ(read_signed_map(file_, {key_}).signature().trusted_comment, "mission 7");
}

TEST_F(MapSignature, NoticesEveryFlippedBitOfFileAndSignature) {
  sign_file(file_, secret_);
  const std::string content = read_file(file_);
  for (std::size_t i = 0; i < content.size(); ++i) {
    std::string flipped = content;
    flipped[i] = static_cast<char>(flipped[i] ^ (1 << (i % 8)));
    testing::overwrite(file_, flipped);
    EXPECT_THROW(read_signed_map(file_, {key_}), IntegrityError) << i;
  }
  testing::overwrite(file_, content);
  const auto signature_path = folder_ / "map.gpkg.minisig";
  const std::string signature = read_file(signature_path);
  const std::size_t first_line = signature.find('\n');
  for (std::size_t i = 0; i < signature.size(); ++i) {
    if (i > 18 && i < first_line) continue;  // the text of the untrusted comment
    for (const std::size_t bit : {i % 7, std::size_t{7}}) {
      std::string flipped = signature;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      testing::overwrite(signature_path, flipped);
      EXPECT_THROW(read_signed_map(file_, {key_}), DataError) << i << ", bit " << bit;
    }
  }
  for (std::size_t size = 0; size + 1 < signature.size(); ++size) {
    testing::overwrite(signature_path, signature.substr(0, size));
    EXPECT_THROW(read_signed_map(file_, {key_}), DataError) << size;
  }
}

TEST_F(MapSignature, RefusesAnotherKey) {
  sign_file(file_, secret_);
  const std::string other = testing::generate_key_pair(folder_ / "b.key", folder_ / "b.pub");
  EXPECT_THAT([&] { read_signed_map(file_, {other}); }, ThrowsMessage<IntegrityError>(HasSubstr("was made with key")));
  EXPECT_EQ(read_signed_map(file_, {other, key_}).signature().trusted_comment, "file:map.gpkg\thashed");
}

TEST_F(MapSignature, AcceptsTheLegacyForm) {
  const MinisignSecretKey secret = parse_secret_key(read_file(secret_), {}, "key");
  const std::string content = read_file(file_);
  MinisignSignature signature;
  signature.prehashed = false;
  signature.key_id = secret.key_id;
  signature.trusted_comment = "old";
  const auto bytes = [](const std::string& text) { return reinterpret_cast<const unsigned char*>(text.data()); };
  crypto_sign_detached(signature.signature.data(), nullptr, bytes(content), content.size(), secret.key.data());
  const std::string global = std::string(signature.signature.begin(), signature.signature.end()) + "old";
  crypto_sign_detached(signature.global_signature.data(), nullptr, bytes(global), global.size(), secret.key.data());
  write_file(folder_ / "map.gpkg.minisig", format_signature_file(signature), false);
  EXPECT_FALSE(read_signed_map(file_, {key_}).signature().prehashed);
  write_file(file_, content + "x", true);
  EXPECT_THROW(read_signed_map(file_, {key_}), IntegrityError);
}

TEST_F(MapSignature, EncryptedKeysNeedTheirPassphrase) {
  const MinisignSecretKey secret = parse_secret_key(read_file(secret_), {}, "key");
  const auto locked = folder_ / "locked.key";
  write_file(locked, testing::encrypted_secret_key_file(secret, "open sesame", kCheap), false);
  EXPECT_THAT([&] { sign_file(file_, locked); }, ThrowsMessage<UsageError>(HasSubstr("is encrypted")));
  SignOptions options;
  options.passphrase = "open barley";
  EXPECT_THAT([&] { sign_file(file_, locked, options); }, ThrowsMessage<UsageError>(HasSubstr("passphrase is wrong")));
  options.passphrase = "open sesame";
  sign_file(file_, locked, options);
  read_signed_map(file_, {key_});
}

TEST_F(MapSignature, SaysWhatIsNotAKey) {
  write_file(folder_ / "bad", "untrusted comment: x\nRWQ\n", false);
  EXPECT_THROW(sign_file(file_, folder_ / "bad"), DataError);
  EXPECT_THROW(sign_file(file_, public_), DataError);
  EXPECT_THROW(sign_file(file_, folder_ / "none"), DataError);
  EXPECT_THROW(sign_file(folder_ / "none", secret_), DataError);
  sign_file(file_, secret_);
  for (const std::string& bad :
       {secret_.string(), std::string("RWQnonsense"), (folder_ / "none.pub").string(), std::string()}) {
    EXPECT_THROW(read_signed_map(file_, {bad}), UsageError) << bad;
    EXPECT_THROW(read_signed_map(file_, {key_, bad}), UsageError) << bad << " beside a good key";
  }
  EXPECT_THROW(read_signed_map(file_, {}), UsageError);
  EXPECT_THROW(read_signed_map(folder_ / "none", {key_}), DataError);
  SignOptions options;
  options.overwrite = true;
  options.trusted_comment = "two\nlines";
  EXPECT_THROW(sign_file(file_, secret_, options), UsageError);
}

TEST_F(MapSignature, MinisignVerifiesOurSignature) {
  if (!has_minisign()) GTEST_SKIP() << "minisign is not installed: apt-get install minisign";
  sign_file(file_, secret_);
  EXPECT_TRUE(minisign("-V -H -p a.pub -m map.gpkg"));
  EXPECT_TRUE(minisign("-V -P " + key_ + " -m map.gpkg"));
  write_file(file_, "other bytes", true);
  EXPECT_FALSE(minisign("-V -p a.pub -m map.gpkg"));
}

TEST_F(MapSignature, WeVerifyMinisignsSignatures) {
  if (!has_minisign()) GTEST_SKIP() << "minisign is not installed: apt-get install minisign";
  ASSERT_TRUE(minisign("-G -W -p m.pub -s m.key"));
  ASSERT_TRUE(minisign("-S -s m.key -m map.gpkg"));
  EXPECT_TRUE(read_signed_map(file_, {(folder_ / "m.pub").string()}).signature().prehashed);
  ASSERT_TRUE(minisign("-S -l -s m.key -m map.gpkg"));
  EXPECT_FALSE(read_signed_map(file_, {(folder_ / "m.pub").string()}).signature().prehashed);
  SignOptions options;
  options.overwrite = true;
  sign_file(file_, folder_ / "m.key", options);
  EXPECT_TRUE(minisign("-V -p m.pub -m map.gpkg"));
  // and its program signs with a key of ours
  ASSERT_TRUE(minisign("-S -s a.key -m map.gpkg"));
  read_signed_map(file_, {key_});
}

}  // namespace
}  // namespace pilotage
