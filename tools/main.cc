#include <iostream>
#include <string>
#include <vector>

#include "commands.h"
#include "run_program.h"

int main(int argc, char** argv) {
  std::vector<pilotage::Command> commands;  // {pilotage::make_<word>_command(), ...} by the way of the data
  return pilotage::run_program(std::move(commands), std::vector<std::string>(argv + 1, argv + argc), std::cout,
                               std::cerr);
}
