#pragma once

#include <string>

namespace pilotage::testing {

/// The message of the `Error` that the call throws, "" when it throws nothing. Any other exception fails the test.
template <class Error, class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace pilotage::testing
