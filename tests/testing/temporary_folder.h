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

/// The folder of real imagery with truth: $PILOTAGE_DATA, else ../shared/data beside the repository; empty when it does
/// not exist. A test that needs it says GTEST_SKIP() with the reason.
std::filesystem::path real_data_folder();

}  // namespace pilotage::testing
