#pragma once

#include <filesystem>

namespace pilotage::testing {

/// A fresh folder that is removed with all it holds when the object dies.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// The folder of real imagery with truth: $PILOTAGE_DATA, else ../shared/data beside the repository; empty when the
/// variable is not set and the other does not exist. Throws std::runtime_error when PILOTAGE_DATA names no folder or an
/// empty one: who sets it wants these tests run. A test that finds nothing here says GTEST_SKIP() << kNoRealImagery.
std::filesystem::path real_data_folder();

inline constexpr const char* kNoRealImagery = "no real imagery: set PILOTAGE_DATA to the folder that holds it";

}  // namespace pilotage::testing
