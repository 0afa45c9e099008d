// Steps that are timed beside each other in one run.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

namespace pilotage {

struct Step {
  std::string name;
  std::function<void()> run;
  std::vector<double> times_s{};
  double processor_s = 1e9;  ///< Of all threads, least of the repeats.
};

/// Does all steps one after the other, `repeats` times.
inline void measure(std::vector<Step>& steps, int repeats) {
  for (int i = 0; i < repeats; ++i) {
    for (Step& step : steps) {
      const auto start = std::chrono::steady_clock::now();
      const std::clock_t processor_start = std::clock();
      step.run();
      step.processor_s =
          std::min(step.processor_s, static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC);
      step.times_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
  }
  for (Step& step : steps) std::sort(step.times_s.begin(), step.times_s.end());
}

/// Best and median time of each step and its processor time, with their ratios to those of one step.
inline void print(const std::vector<Step>& steps, std::size_t reference) {
  const auto median = [](const Step& step) { return step.times_s[step.times_s.size() / 2]; };
  const Step& one = steps[reference];
  for (const Step& step : steps) {
    std::printf("%-32s best %7.1f ms (%5.2f)  median %7.1f ms (%5.2f)  processor %7.1f ms (%5.2f)\n", step.name.c_str(),
                1e3 * step.times_s.front(), step.times_s.front() / one.times_s.front(), 1e3 * median(step),
                median(step) / median(one), 1e3 * step.processor_s, step.processor_s / one.processor_s);
  }
}

}  // namespace pilotage
