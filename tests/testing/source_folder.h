#pragma once

#include <filesystem>

namespace pilotage::testing {

/// The folder of the repository that is tested. One object knows it: the others compile to the same in every checkout.
std::filesystem::path source_folder();

}  // namespace pilotage::testing
