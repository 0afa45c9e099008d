#include "pilotage/mapdb/key_list.h"

#include <cstdlib>
#include <map>

#include "testing/key_pair.h"
#include "testing/overwrite.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/key_list_text.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mapdb/map_signing.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Keys of two roots and three planners, and lists of them.
class KeyListTest : public ::testing::Test {
 protected:
  KeyListTest() {
    for (const char* name : {"root_a", "root_b", "desk", "field", "stranger"}) {
      keys_[name] =
          testing::generate_key_pair(folder_ / (std::string(name) + ".key"), folder_ / (std::string(name) + ".pub"));
    }
  }

  std::string text(int version, const std::string& roots_and_signers) const {
    std::string list = "pilotage key list 1\n# kept by the head office\nversion " + std::to_string(version) +
                       "\nvalid-until 2027-03-01T00:00:00Z\n\n";
    std::string word;
    for (const char c : roots_and_signers + " ") {
      if (c != ' ') {
        word += c;
        continue;
      }
      list += (word.starts_with("root") ? "root " : "signer ") + keys_.at(word) + " the " + word + "\n";
      word.clear();
    }
    return list;
  }
  /// Writes a list and signs it.
  std::filesystem::path list(int version, const std::string& roots_and_signers, const std::string& signed_by) const {
    const auto path = folder_ / (std::to_string(version) + ".keys");
    write_file(path, text(version, roots_and_signers), true);
    SignOptions options;
    options.overwrite = true;
    sign_file(path, folder_ / (signed_by + ".key"), options);
    return path;
  }
  const std::string& key(const std::string& name) const { return keys_.at(name); }

  testing::TemporaryFolder folder_;
  std::map<std::string, std::string> keys_;
};

TEST_F(KeyListTest, SaysWhoMaySignMaps) {
  const KeyList read = read_key_lists({list(3, "root_a root_b desk field", "root_a")}, {key("root_a")});
  EXPECT_EQ(read.version, 3);
  EXPECT_EQ(format_utc_time(read.valid_until), "2027-03-01T00:00:00Z");
  EXPECT_THAT(read.trusted_keys(), ElementsAre(key("desk"), key("field")));
  EXPECT_EQ(read.roots.size(), 2U);
  write_file(folder_ / "map", "a map", false);
  sign_file(folder_ / "map", folder_ / "field.key");
  const SignatureInfo signature = read_signed_map(folder_ / "map", read.trusted_keys()).signature();
  ASSERT_NE(read.find_signer(signature.key_id), nullptr);
  EXPECT_EQ(read.find_signer(signature.key_id)->name, "the field");
  EXPECT_EQ(read.find_signer("0"), nullptr);
}

TEST_F(KeyListTest, ASignerThatIsLeftOutIsNoLongerTrusted) {
  write_file(folder_ / "map", "a map", false);
  sign_file(folder_ / "map", folder_ / "field.key");
  const KeyList read = read_key_lists({list(4, "root_a desk", "root_a")}, {key("root_a")});
  EXPECT_THAT([&] { read_signed_map(folder_ / "map", read.trusted_keys()); },
              ThrowsMessage<IntegrityError>(HasSubstr("was made with key")));
}

TEST_F(KeyListTest, OnlyARootSignsAList) {
  for (const char* other : {"desk", "stranger", "root_b"}) {
    const auto path = list(3, "root_a desk", other);
    EXPECT_THROW(read_key_lists({path}, {key("root_a")}), IntegrityError) << other;
  }
  const auto path = list(3, "root_a desk", "root_a");
  EXPECT_THROW(read_key_lists({path}, {}), UsageError);
  EXPECT_THROW(read_key_lists({path}, {""}), UsageError);
  EXPECT_THROW(read_key_lists({}, {key("root_a")}), UsageError);
  std::filesystem::remove(signature_path_of(path));
  EXPECT_THROW(read_key_lists({path}, {key("root_a")}), DataError);
}

TEST_F(KeyListTest, RefusesAnOlderListAndAnExpiredOne) {
  const auto path = list(3, "root_a desk", "root_a");
  KeyListRequirements required{3, parse_utc_time("2027-02-28T23:59:59Z")};
  read_key_lists({path}, {key("root_a")}, required);
  required.min_version = 4;
  EXPECT_THAT([&] { read_key_lists({path}, {key("root_a")}, required); },
              ThrowsMessage<IntegrityError>(HasSubstr("is version 3, and at least 4 is asked for")));
  required = {3, parse_utc_time("2027-03-01T00:00:00Z")};
  EXPECT_THAT([&] { read_key_lists({path}, {key("root_a")}, required); },
              ThrowsMessage<IntegrityError>(HasSubstr("expired at 2027-03-01T00:00:00Z")));
}

TEST_F(KeyListTest, ANewRootIsIntroducedByAnOldOne) {
  const auto first = list(1, "root_a desk", "root_a");
  const auto second = list(2, "root_b desk", "root_a");
  const auto third = list(5, "root_b field", "root_b");
  EXPECT_THAT(read_key_lists({first, second, third}, {key("root_a")}).trusted_keys(), ElementsAre(key("field")));
  EXPECT_THAT(read_key_lists({second, third}, {key("root_a")}, {5, {}}).trusted_keys(), ElementsAre(key("field")));
  EXPECT_THAT(read_key_lists({third}, {key("root_b")}).trusted_keys(), ElementsAre(key("field")));
  EXPECT_THROW(read_key_lists({first, third}, {key("root_a")}), IntegrityError) << "the list in between is missing";
  EXPECT_THAT(
      [&] {
        read_key_lists({second, third, third}, {key("root_a")});
      },
      ThrowsMessage<IntegrityError>(HasSubstr("from the oldest to the newest")));
  const auto old_root = list(6, "root_a stranger", "root_a");
  EXPECT_THROW(read_key_lists({first, second, old_root}, {key("root_a")}), IntegrityError) << "root_a was replaced";
}

TEST_F(KeyListTest, NoticesEveryFlippedBitAndEveryLengthOfListAndSignature) {
  const auto path = list(3, "root_a desk", "root_a");
  for (const auto& file : {path, signature_path_of(path)}) {
    const std::string content = read_file(file);
    for (std::size_t i = 0; i < content.size(); ++i) {
      if (file != path && i > 18 && i < content.find('\n')) continue;  // the text of the untrusted comment
      std::string flipped = content;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << (i % 7)));
      testing::overwrite(file, flipped);
      EXPECT_THROW(read_key_lists({path}, {key("root_a")}), DataError) << file << " " << i;
      if (file != path && i + 1 == content.size()) break;  // the last line end may be missing
      testing::overwrite(file, content.substr(0, i));
      EXPECT_THROW(read_key_lists({path}, {key("root_a")}), DataError) << file << " cut to " << i;
    }
    testing::overwrite(file, content);
  }
}

TEST_F(KeyListTest, ReadsItsOwnFormAndNoOther) {
  const std::string good = text(3, "root_a desk");
  EXPECT_EQ(parse_key_list(good, "list").version, 3);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = good;
    return changed.replace(changed.find(from), from.size(), to);
  };
  for (const std::string& wrong :
       {std::string(), with("list 1", "list 2"), with("version 3", "version 0"), with("version 3", "version 03x"),
        with("version 3", "Version 3"), with("T00:00:00Z", ""), with("root ", "rot "), with("signer ", "root "),
        with("the desk", ""), with(" the desk", "x the desk"), with("the desk", std::string(101, 'x')),
        with("the desk", "the\tdesk"), good + "more", good + "version 4\n", with("\n# kept", "\r\n# kept"),
        good + "signer " + key("desk") + " again\n", good + "signer " + key("root_a") + " again\n",
        good + "root " + key("field") + " too late\n", good.substr(0, good.size() - 1)}) {
    EXPECT_THROW(parse_key_list(wrong, "list"), DataError) << wrong;
  }
  EXPECT_THAT([&] { parse_key_list(with("version 3", "version x"), "list"); },
              ThrowsMessage<DataError>(HasSubstr("list: line 3: the version is not a number from 1")));
}

TEST_F(KeyListTest, MinisignSignsAList) {
  if (std::system("minisign -v >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "minisign is not installed: apt-get install minisign";
  const auto path = folder_ / "m.keys";
  write_file(path, text(3, "root_a desk"), false);
  const auto minisign = [&](const std::string& arguments) {
    return std::system(("cd '" + folder_.path().string() + "' && minisign " + arguments + " >/dev/null 2>&1").c_str());
  };
  ASSERT_EQ(minisign("-G -W -p m.pub -s m.key"), 0);
  ASSERT_EQ(minisign("-S -s m.key -m m.keys"), 0);
  EXPECT_EQ(read_key_lists({path}, {(folder_ / "m.pub").string()}).version, 3);
  list(4, "root_a desk", "root_a");
  EXPECT_EQ(minisign("-V -p root_a.pub -m 4.keys"), 0);
}

}  // namespace
}  // namespace pilotage
