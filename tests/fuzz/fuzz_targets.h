#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "pilotage/base/random.h"

namespace pilotage {

// Each takes any bytes, whatever they are, and aborts where something does not hold. fuzz_<name> is in <name>_fuzz.cc.
void fuzz_airsim(const std::uint8_t* data, std::size_t size);
void fuzz_airsim_recording(const std::uint8_t* data, std::size_t size);
void fuzz_camera(const std::uint8_t* data, std::size_t size);
void fuzz_chunks(const std::uint8_t* data, std::size_t size);
void fuzz_dataflash(const std::uint8_t* data, std::size_t size);
void fuzz_delta(const std::uint8_t* data, std::size_t size);
void fuzz_frames(const std::uint8_t* data, std::size_t size);
void fuzz_key_list(const std::uint8_t* data, std::size_t size);
void fuzz_map(const std::uint8_t* data, std::size_t size);
void fuzz_match(const std::uint8_t* data, std::size_t size);
void fuzz_model(const std::uint8_t* data, std::size_t size);
void fuzz_options(const std::uint8_t* data, std::size_t size);
void fuzz_pack(const std::uint8_t* data, std::size_t size);
void fuzz_plan(const std::uint8_t* data, std::size_t size);
void fuzz_route(const std::uint8_t* data, std::size_t size);
void fuzz_selection(const std::uint8_t* data, std::size_t size);
void fuzz_shard(const std::uint8_t* data, std::size_t size);
void fuzz_signature(const std::uint8_t* data, std::size_t size);
void fuzz_telemetry(const std::uint8_t* data, std::size_t size);
void fuzz_tiles(const std::uint8_t* data, std::size_t size);
void fuzz_ulog(const std::uint8_t* data, std::size_t size);

/// A map with one to three changes of its structure (testing/forged_map.h); `bytes` where they are no file of pages.
std::string forge_map(const std::string& bytes, Random& random);

struct FuzzTarget {
  std::string_view name;
  void (*run)(const std::uint8_t* data, std::size_t size);
  /// Changes the structure of an input, where the target knows it; every other mutation is then one of these.
  std::string (*forge)(const std::string& bytes, Random& random) = nullptr;
};

inline constexpr FuzzTarget kFuzzTargets[] = {
    {"airsim", fuzz_airsim},       {"airsim_recording", fuzz_airsim_recording},
    {"camera", fuzz_camera},       {"chunks", fuzz_chunks},
    {"dataflash", fuzz_dataflash}, {"delta", fuzz_delta},
    {"frames", fuzz_frames},       {"key_list", fuzz_key_list},
    {"map", fuzz_map, forge_map},  {"match", fuzz_match},
    {"model", fuzz_model},         {"options", fuzz_options},
    {"pack", fuzz_pack},           {"plan", fuzz_plan},
    {"route", fuzz_route},         {"selection", fuzz_selection},
    {"shard", fuzz_shard},         {"signature", fuzz_signature},
    {"telemetry", fuzz_telemetry}, {"tiles", fuzz_tiles},
    {"ulog", fuzz_ulog},
};

/// Aborts when `condition` does not hold, saying what should have held.
inline void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "not so: %s\n", what);
  std::abort();
}

}  // namespace pilotage
