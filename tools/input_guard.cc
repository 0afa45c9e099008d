#include "input_guard.h"

#include <system_error>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  if (std::filesystem::equivalent(a, b, ignored)) return true;
  return std::filesystem::absolute(a, ignored).lexically_normal() ==
         std::filesystem::absolute(b, ignored).lexically_normal();
}

}  // namespace

void refuse_shared_files(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string what = outputs[i].flag + " = \"" + outputs[i].path.string() + "\" is also ";
    for (const NamedFile& input : inputs) {
      if (same_file(outputs[i].path, input.path)) {
        throw UsageError(what + "an input (" + input.flag + "), which would be lost; write somewhere else");
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (same_file(outputs[i].path, outputs[j].path)) {
        throw UsageError(what + "what " + outputs[j].flag + " writes; give each output a name of its own");
      }
    }
  }
}

}  // namespace pilotage
