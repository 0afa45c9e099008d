// A program with the one command of toy_command.h: what the framework does, as a process sees it (signals, streams).
#include <iostream>

#include "cli/toy_command.h"
#include "run_program.h"

int main(int argc, char** argv) {
  return pilotage::run_program({pilotage::make_toy_command()}, {argv + 1, argv + argc}, std::cout, std::cerr);
}
