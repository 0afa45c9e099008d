#include <iostream>
#include <string>
#include <vector>

#include "command.h"
#include "run_program.h"

int main(int argc, char** argv) {
  std::vector<pilotage::Command> commands;
  return pilotage::run_program(std::move(commands), std::vector<std::string>(argv + 1, argv + argc), std::cout,
                               std::cerr);
}
