#include "pilotage/route/mission_command.h"

#include <algorithm>
#include <array>

namespace pilotage {
namespace {

using enum CommandRole;

constexpr std::array kCommands = {
    CommandInfo{16, "waypoint", kPath},
    CommandInfo{17, "loiter", kPath},
    CommandInfo{18, "loiter turns", kPath},
    CommandInfo{19, "loiter time", kPath},
    CommandInfo{20, "return to launch", kReturn},
    CommandInfo{21, "land", kLand},
    CommandInfo{22, "takeoff", kTakeoff},
    CommandInfo{23, "land at local position", kLocal},
    CommandInfo{24, "takeoff from local position", kLocal},
    CommandInfo{30, "continue and change altitude", kClimb},
    CommandInfo{31, "loiter to altitude", kPath},
    CommandInfo{34, "orbit", kPath},
    CommandInfo{80, "region of interest", kPlaceNotFlownTo},
    CommandInfo{82, "spline waypoint", kPath},
    CommandInfo{83, "wait for altitude", kNoPlace},
    CommandInfo{84, "VTOL takeoff", kTakeoff},
    CommandInfo{85, "VTOL land", kLand},
    CommandInfo{92, "guided enable", kNoPlace},
    CommandInfo{93, "delay", kNoPlace},
    CommandInfo{94, "payload place", kLand},
    CommandInfo{112, "delay condition", kNoPlace},
    CommandInfo{113, "altitude condition", kNoPlace},
    CommandInfo{114, "distance condition", kNoPlace},
    CommandInfo{115, "yaw condition", kNoPlace},
    CommandInfo{176, "set mode", kNoPlace},
    CommandInfo{177, "jump", kJump},
    CommandInfo{178, "change speed", kSpeed},
    CommandInfo{179, "set home", kPlaceNotFlownTo},
    CommandInfo{181, "set relay", kNoPlace},
    CommandInfo{182, "repeat relay", kNoPlace},
    CommandInfo{183, "set servo", kNoPlace},
    CommandInfo{184, "repeat servo", kNoPlace},
    CommandInfo{189, "landing start", kPlaceNotFlownTo},
    CommandInfo{195, "region of interest at a location", kPlaceNotFlownTo},
    CommandInfo{196, "region of interest at the next waypoint", kNoPlace},
    CommandInfo{197, "end of region of interest", kNoPlace},
    CommandInfo{200, "control video", kNoPlace},
    CommandInfo{201, "set region of interest", kPlaceNotFlownTo},
    CommandInfo{202, "configure camera", kNoPlace},
    CommandInfo{203, "control camera", kNoPlace},
    CommandInfo{204, "configure mount", kNoPlace},
    CommandInfo{205, "control mount", kNoPlace},
    CommandInfo{206, "camera trigger distance", kNoPlace},
    CommandInfo{207, "fence enable", kNoPlace},
    CommandInfo{208, "parachute", kNoPlace},
    CommandInfo{211, "gripper", kNoPlace},
    CommandInfo{212, "autotune", kNoPlace},
    CommandInfo{214, "camera trigger interval", kNoPlace},
    CommandInfo{530, "set camera mode", kNoPlace},
    CommandInfo{531, "set camera zoom", kNoPlace},
    CommandInfo{532, "set camera focus", kNoPlace},
    CommandInfo{600, "jump tag", kTag},
    CommandInfo{601, "jump to tag", kJumpToTag},
    CommandInfo{1000, "gimbal pitch and yaw", kNoPlace},
    CommandInfo{2000, "start image capture", kNoPlace},
    CommandInfo{2001, "stop image capture", kNoPlace},
    CommandInfo{2003, "camera trigger control", kNoPlace},
    CommandInfo{2500, "start video capture", kNoPlace},
    CommandInfo{2501, "stop video capture", kNoPlace},
    CommandInfo{3000, "VTOL transition", kNoPlace},
    CommandInfo{5001, "polygon fence, inclusion", kPlaceNotFlownTo},
    CommandInfo{5002, "polygon fence, exclusion", kPlaceNotFlownTo},
    CommandInfo{5003, "circle fence, inclusion", kPlaceNotFlownTo},
    CommandInfo{5004, "circle fence, exclusion", kPlaceNotFlownTo},
    CommandInfo{5100, "rally point", kPlaceNotFlownTo},
};

}  // namespace

CommandInfo command_info(int command) {
  const auto it = std::find_if(kCommands.begin(), kCommands.end(),
                               [&](const CommandInfo& info) { return info.command == command; });
  return it == kCommands.end() ? CommandInfo{command, "", kUnknown} : *it;
}

}  // namespace pilotage
