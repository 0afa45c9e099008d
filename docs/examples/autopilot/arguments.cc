#include "arguments.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <type_traits>

const char* const kUsage =
    R"(usage: autopilot_example MAP.gpkg (--link LINK | --recording FLIGHT.tlog) --send MESSAGES
                         (--public-key KEY | --unverified) [OPTIONS] < PICTURES

Pictures come through standard input: binary PGM, 8 bits, one behind the other.

  --link LINK          udp:HOST:PORT, udpin:PORT or serial:DEVICE:BAUD
  --recording FILE     what a flight recorded (.tlog) in place of a link
  --send MESSAGES      gps_input, external_position_estimate, global_position_sensor; several with commas between
  --also-map MAP       another map of the ground, as of another date: each picture is asked of each; several times for more
  --public-key KEY     whose signature of the maps is trusted; --unverified: any map
  --record FILE        write what is heard and said (.tlog)
  --system-id N        of the aircraft: whom it hears and speaks to (1)
  --component-id N     of this program (191)
  --sensor-id N        gps_id of GPS_INPUT, id of GLOBAL_POSITION_SENSOR (1)
  --rate-hz F          of GPS_INPUT, 5 to 20 (10)
  --max-sigma-m F      GPS_INPUT says "no fix" beyond it (100)
  --imu-rate-hz F      asked of the autopilot (100)
  --camera-latency-ms F  from exposure to a picture's first byte, where a picture does not say (50)
  --hold-back-ms F     how late a picture may come after its exposure (100)
  --deadline-ms F      of the matching of a picture (1000)
  --ins-grade GRADE    consumer, industrial, tactical, navigation (consumer)
  --ground-amsl-m F    height of level ground, for want of a rangefinder and a terrain report
  --start-sigma-m F    begin without GNSS, once: how far off the autopilot's position may be
)";

namespace {

double number_of(const std::string& name, const std::string& word, double least, double most) {
  double number = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), number);
  if (read.ec != std::errc{} || read.ptr != word.data() + word.size() || !(number >= least && number <= most)) {
    std::ostringstream text;
    text << name << " " << word << ": a number from " << least << " to " << most << " is wanted";
    throw std::invalid_argument(text.str());
  }
  return number;
}

void set_messages(FlightOptions& flight, const std::string& names) {
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, ',');) {
    if (name == "gps_input") {
      flight.sends_gps_input = true;
    } else if (name == "external_position_estimate") {
      flight.sends_external_position_estimate = true;
    } else if (name == "global_position_sensor") {
      flight.sends_global_position_sensor = true;
    } else {
      throw std::invalid_argument("--send " + name +
                                  ": there are gps_input, external_position_estimate and global_position_sensor");
    }
  }
}

pilotage::InsGrade grade_of(const std::string& word) {
  const std::map<std::string, pilotage::InsGrade> grades = {{"consumer", pilotage::InsGrade::kConsumer},
                                                            {"industrial", pilotage::InsGrade::kIndustrial},
                                                            {"tactical", pilotage::InsGrade::kTactical},
                                                            {"navigation", pilotage::InsGrade::kNavigation}};
  const auto grade = grades.find(word);
  if (grade == grades.end()) {
    throw std::invalid_argument("--ins-grade " + word + ": there are consumer, industrial, tactical and navigation");
  }
  return grade->second;
}

}  // namespace

Arguments read_arguments(int argc, char** argv) {
  Arguments arguments;
  FlightOptions& flight = arguments.flight;
  using Set = std::function<void(const std::string& name, const std::string& word)>;
  const auto text = [](std::string& value) {
    return [&value](const std::string&, const std::string& word) { value = word; };
  };
  const auto number = [](auto& value, double least, double most, double unit = 1) {
    return [&value, least, most, unit](const std::string& name, const std::string& word) {
      using Value = std::remove_reference_t<decltype(value)>;
      const double given = number_of(name, word, least, most);
      if (std::is_integral_v<Value> && given != std::floor(given)) {
        throw std::invalid_argument(name + " " + word + ": a whole number is wanted");
      }
      value = static_cast<Value>(given * unit);
    };
  };
  const std::map<std::string, Set> options = {
      {"--also-map", [&](const std::string&, const std::string& word) { arguments.also_map.push_back(word); }},
      {"--link", text(arguments.link)},
      {"--recording", text(arguments.recording)},
      {"--record", text(arguments.record)},
      {"--public-key", text(arguments.public_key)},
      {"--send", [&](const std::string&, const std::string& word) { set_messages(flight, word); }},
      {"--system-id", number(flight.sender.system_id, 1, 255)},
      {"--component-id", number(flight.sender.component_id, 1, 255)},
      {"--sensor-id", number(flight.sensor_id, 0, 255)},
      {"--rate-hz", number(flight.rate_hz, 5, 20)},
      {"--max-sigma-m", number(flight.max_sigma_m, 0.1, 100)},
      {"--imu-rate-hz", number(flight.imu_rate_hz, 10, 1000)},
      {"--camera-latency-ms", number(flight.camera_latency_s, 0, 1000, 1e-3)},
      {"--hold-back-ms", number(flight.hold_back_s, 0, 900, 1e-3)},
      {"--deadline-ms", number(flight.deadline_ms, 1, 60000)},
      {"--ins-grade", [&](const std::string&, const std::string& word) { flight.ins_grade = grade_of(word); }},
      {"--ground-amsl-m", number(flight.ground_amsl_m, -500, 9000)},
      {"--start-sigma-m", number(flight.start_sigma_m, 0.01, 1000)},
  };
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--unverified") {
      arguments.unverified = true;
    } else if (const auto option = options.find(word); option != options.end()) {
      if (i + 1 == argc) throw std::invalid_argument(word + ": a value is missing");
      option->second(word, argv[++i]);
    } else if (arguments.map.empty() && !word.starts_with("--")) {
      arguments.map = word;
    } else {
      throw std::invalid_argument(word + ": not known");
    }
  }
  if (arguments.map.empty()) throw std::invalid_argument("a map is missing");
  if (arguments.link.empty() == arguments.recording.empty()) {
    throw std::invalid_argument("one of --link and --recording is wanted");
  }
  if (arguments.public_key.empty() != arguments.unverified) {
    throw std::invalid_argument("one of --public-key and --unverified is wanted");
  }
  if (!flight.sends_gps_input && !flight.sends_external_position_estimate && !flight.sends_global_position_sensor) {
    throw std::invalid_argument("--send is missing");
  }
  if (flight.sends_global_position_sensor && flight.sensor_id == 0) {
    throw std::invalid_argument("--sensor-id 0: to PX4 that is no source of global_position_sensor");
  }
  if (flight.hold_back_s <= flight.camera_latency_s) {
    throw std::invalid_argument("--hold-back-ms must be above --camera-latency-ms, or every picture comes too late");
  }
  return arguments;
}
