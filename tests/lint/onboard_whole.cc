#include <iostream>

#include "pilotage/geo/local_frame.h"

int main() {
  std::cout << "pilotage::onboard is complete\n";
}
