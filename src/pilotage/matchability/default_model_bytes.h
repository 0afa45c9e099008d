#pragma once

#include <string_view>

/// default_model.json, embedded at build time (cmake/embed_files.cmake).
namespace pilotage::default_model {

std::string_view bytes();

}  // namespace pilotage::default_model
