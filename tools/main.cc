#include <iostream>
#include <string>
#include <vector>

#include "commands.h"
#include "run_program.h"
#include <malloc.h>

namespace {

// Threads come and go with every parallel loop, and glibc keeps what they free in up to eight arenas a core, which made
// the memory of long runs grow by half. Two are as fast.
void bound_malloc_arenas() {
#if defined(__GLIBC__)
  mallopt(M_ARENA_MAX, 2);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  using namespace pilotage;
  bound_malloc_arenas();
  std::vector<Command> commands{make_prepare_command(),    make_tile_command(),    make_score_command(),
                                make_merge_command(),      make_select_command(),  make_build_command(),
                                make_report_command(),     make_inspect_command(), make_verify_command(),
                                make_match_command(),      make_compare_command(), make_calibrate_command(),
                                make_completion_command(), make_manual_command()};
  return run_program(std::move(commands), std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr);
}
