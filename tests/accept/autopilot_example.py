"""The program of docs/examples/autopilot, built against an installed onboard library: a straight flight over the sample's
second date as an autopilot and a camera tell it, recorded and live, and what comes out read by MAVLink's definitions.

autopilot_example.py PILOTAGE SOURCE_FOLDER CUT_FLIGHT_FRAMES INSTALLED GENERATOR CXX LAUNCHER SANITIZERS"""

import csv
import json
import math
import os
import pty
import random
import select
import signal
import socket
import subprocess
import sys
import threading
import time
import tty

from acceptance import SKIP, check, main, run
from library_user import Toolchain, build_example
from mavlink_reading import EXTRA, crc_x25, read_frame, read_recording, recorded, write_frame
from whole_map import make_whole_map

CAMERA = (73.7, 800, 450)  # degrees, pixels
FOOTPRINT_M = 180
FRAMES = 24
SPEED_MPS = 20
SPACING_S = 2
LEAD_S = 6  # of flight before the first frame
ROUTE = [[16.4856, 55.4990], [16.5014, 55.4990]]  # some 1,000 m eastwards over the sample
WEST_PX = 2100  # columns of the sample, up to the middle of the route
GROUND_AMSL_M = 50
BOOT_S = 100  # by the autopilot's clock, when the flight begins
WAY_S = 0.003  # of a message from the autopilot
EPOCH_US = 1_800_000_000_000_000  # by this computer's, in a recording
RADIUS_M = 6371000  # a sphere does for a kilometre
EARTH_RADPS = 7.292115e-5
# By hand from the generated headers (MAVLINK_MSG_ID_…_CRC).
KNOWN_EXTRA = {0: 50, 24: 24, 30: 39, 33: 104, 75: 158, 76: 152, 77: 143, 105: 93, 132: 85, 135: 203, 136: 1, 232: 151, 253: 83, 296: 158}
POSITION_ONLY = 2 | 4 | 8 | 16 | 32  # GPS_INPUT_IGNORE_FLAGS: HDOP, VDOP, both velocities, accuracy of the speed


class Truth:
    """A straight and level flight through the frames' places, at constant speed."""

    def __init__(self, rows):
        places = [(float(row["true_nadir_lon_deg"]), float(row["true_nadir_lat_deg"])) for row in rows]
        self.first = places[0]
        flown_s = SPACING_S * (len(rows) - 1)
        self.per_s = [(last - first) / flown_s for first, last in zip(places[0], places[-1])]
        lat = math.radians(places[0][1])
        self.meridian_m, self.parallel_m = 6366000, 6392000 * math.cos(lat)  # radii of curvature at this latitude, nearly
        self.velocity_en_mps = (math.radians(self.per_s[0]) * self.parallel_m, math.radians(self.per_s[1]) * self.meridian_m)
        self.yaw_deg = math.degrees(math.atan2(*self.velocity_en_mps))
        self.agl_m = float(rows[0]["true_height_agl_m"])
        self.lat_rad = lat
        off = [math.dist(self.at(LEAD_S + SPACING_S * i), place) for i, place in enumerate(places)]
        check(max(off) < 1e-6, f"the frames do not lie on a straight line at equal distances: {max(off)} degrees off")

    def at(self, flown_s):
        return tuple(first + rate * (flown_s - LEAD_S) for first, rate in zip(self.first, self.per_s))

    def error_m(self, flown_s, lon_deg, lat_deg):
        lon, lat = self.at(flown_s)
        return math.hypot(math.radians(lon_deg - lon) * self.parallel_m, math.radians(lat_deg - lat) * self.meridian_m)

    def imu(self, noise, pitch_deg=0, roll_deg=0):
        """Specific force and rate along the body's axes: nose, right wing, belly."""
        east, north = self.velocity_en_mps
        turn = (EARTH_RADPS * math.cos(self.lat_rad) + east / RADIUS_M, -north / RADIUS_M,
                -EARTH_RADPS * math.sin(self.lat_rad) - east * math.tan(self.lat_rad) / RADIUS_M)  # north, east, down
        both = (turn[0] + EARTH_RADPS * math.cos(self.lat_rad), turn[1], turn[2] - EARTH_RADPS * math.sin(self.lat_rad))
        velocity = (north, east, 0)
        coriolis = [both[1] * velocity[2] - both[2] * velocity[1], both[2] * velocity[0] - both[0] * velocity[2],
                    both[0] * velocity[1] - both[1] * velocity[0]]
        gravity = 9.780327 * (1 + 0.0053024 * math.sin(self.lat_rad)**2) - 3.086e-6 * (GROUND_AMSL_M + self.agl_m)
        yaw, pitch, roll = (math.radians(angle) for angle in (self.yaw_deg, pitch_deg, roll_deg))

        def body(ned):
            x, y, z = math.cos(yaw) * ned[0] + math.sin(yaw) * ned[1], -math.sin(yaw) * ned[0] + math.cos(yaw) * ned[1], ned[2]
            x, z = math.cos(pitch) * x - math.sin(pitch) * z, math.sin(pitch) * x + math.cos(pitch) * z
            return [x, math.cos(roll) * y + math.sin(roll) * z, -math.sin(roll) * y + math.cos(roll) * z]
        force = body([coriolis[0], coriolis[1], coriolis[2] - gravity])
        return [x + noise.gauss(0, 0.02) for x in force], [x + noise.gauss(0, 1e-3) for x in body(turn)]


class Told:
    """What an autopilot tells of the flight. Its own position, and its receiver's, are 400 m off from leaves_truth_s on: GNSS has
    failed, or lies."""

    def __init__(self, height="range", gnss_fix=3, h_acc_m=2, silent=(1e9, 1e9), leaves_truth_s=8, pitch_deg=0, roll_deg=0, climb_mps=0,
                 gnss_until_s=1e9, refuses=False, reboots_s=1e9, imu_ids=(0, 0), deaf=(1e9, 1e9)):
        self.__dict__.update({name: value for name, value in locals().items() if name != "self"})

    def stamp_s(self, flown_s):
        return flown_s + BOOT_S if flown_s < self.reboots_s else flown_s - self.reboots_s + 1

    def words(self, truth, seconds):
        """(seconds of flight, frame of MAVLink)"""
        noise = random.Random(1)
        sequence = 0
        for step in range(int(seconds * 100)):
            flown_s = step / 100
            for number, values in self.at(truth, step, flown_s, noise):
                # The first half second in MAVLink 1, as PX4 begins.
                version = 1 if flown_s < 0.5 and number != 24 else 2
                yield flown_s, write_frame(number, sequence, version=version, **values)
                sequence += 1

    def at(self, truth, step, flown_s, noise):
        stamp_ms = round(self.stamp_s(flown_s) * 1000)
        height_m = GROUND_AMSL_M + truth.agl_m + self.climb_mps * flown_s
        lon, lat = truth.at(flown_s)
        lat += 0.0036 if flown_s >= self.leaves_truth_s else 0
        e7 = dict(lat=round(lat * 1e7), lon=round(lon * 1e7))
        east, north = truth.velocity_en_mps
        if step % 100 == 0:
            yield 0, dict(type=2, autopilot=3, system_status=4, mavlink_version=3)
        force, rate = truth.imu(noise, self.pitch_deg, self.roll_deg)
        if not self.silent[0] <= flown_s < self.silent[1]:
            yield 105, dict(time_usec=stamp_ms * 1000, xacc=force[0], yacc=force[1], zacc=force[2], xgyro=rate[0], ygyro=rate[1],
                            zgyro=rate[2], pressure_alt=height_m + 37 + noise.gauss(0, 0.3), fields_updated=0xFFF, id=self.imu_ids[flown_s >= self.reboots_s])
        if step % 5 == 0 and not self.deaf[0] <= flown_s < self.deaf[1]:
            yield 30, dict(time_boot_ms=stamp_ms, **{name: math.radians(angle) for name, angle in (
                ("yaw", truth.yaw_deg), ("pitch", self.pitch_deg), ("roll", self.roll_deg))})
        if step % 10 == 0:
            yield 33, dict(time_boot_ms=stamp_ms, alt=round(height_m * 1000), vx=round(north * 100), vy=round(east * 100),
                           vz=round(-self.climb_mps * 100), **e7)
            if self.height == "range":
                yield 132, dict(time_boot_ms=stamp_ms, min_distance=20, max_distance=50000, orientation=25,
                                current_distance=round(truth.agl_m * 100))
        if step % 50 == 0:
            yield 24, dict(time_usec=stamp_ms * 1000, fix_type=self.gnss_fix if flown_s < self.gnss_until_s else 1,
                           h_acc=round(self.h_acc_m * 1000), **e7)
            if self.height == "terrain":  # of the true place, as it is asked for
                yield 136, dict(spacing=100, terrain_height=GROUND_AMSL_M, lat=round(truth.at(flown_s)[1] * 1e7), lon=e7["lon"])
            if self.refuses:
                yield 77, dict(command=43003, result=4)


def picture(row, exposure_us):
    data = row["file"].read_bytes()
    check(data.startswith(b"P5\n"), f"{row['file']}: no PGM")
    return b"P5\n# exposure_us %d\n" % exposure_us + data[3:]


class Program:
    def __init__(self, example, map_path, rows, truth, work):
        self.example, self.map_path, self.rows, self.truth, self.work = example, map_path, rows, truth, work
        self.runs = 0

    def fly_recorded(self, *options, frames=range(FRAMES), seconds=LEAD_S + SPACING_S * FRAMES, **told):
        """What the program says of a recorded flight: (seconds of flight, number, members), and its summary."""
        self.runs += 1
        recording, out = self.work / f"flight_{self.runs}.tlog", self.work / f"out_{self.runs}.tlog"
        recording.write_bytes(b"".join(recorded(EPOCH_US + round((flown_s + WAY_S) * 1e6), frame)
                                       for flown_s, frame in Told(**told).words(self.truth, seconds)))
        pictures = b"".join(picture(self.rows[i], EPOCH_US + (LEAD_S + SPACING_S * i) * 1_000_000) for i in frames)
        done = subprocess.run([self.example, self.map_path, "--unverified", "--recording", recording, "--record", out, *options],
                              input=pictures, capture_output=True)
        check(done.returncode == 0, done.stderr.decode())
        said = [(time_us, *frame) for time_us, *frame in own(out.read_bytes())]
        for text in texts([(0, frame[4], frame[5]) for frame in said]):
            check(text.startswith("Pilotage: ") and len(text) < 50, f"{text} is cut off")
        check([frame[1] for frame in said] == [i % 256 for i in range(len(said))], "the sequence of what it says has holes")
        return [((time_us - EPOCH_US) / 1e6, number, values) for time_us, _, _, _, number, values in said], done.stderr.decode()


def own(recording):
    """Of a recording what the program said itself, without what it heard (of which some is MAVLink 1)."""
    at = 0
    while at < len(recording):
        newer = recording[at + 8] == 0xFD
        size = recording[at + 9] + (12 if newer else 8)
        if newer and recording[at + 8 + 6] == 191:
            yield from read_recording(recording[at:at + 8 + size])
        at += 8 + size


def texts(said):
    return [values["text"].rstrip(b"\0").decode() for _, number, values in said if number == 253]


def check_gps_input(truth, flown_s, values):
    """Position only: what is not known is not told. Returns its error in metres and in sigmas."""
    check((values["ignore_flags"], values["gps_id"], values["time_week"], values["time_week_ms"], values["yaw"]) ==
          (POSITION_ONLY, 1, 0, 0, 0), str(values))
    check(not any(values[name] for name in ("vn", "ve", "vd", "hdop", "vdop", "speed_accuracy", "satellites_visible")), str(values))
    off_m = truth.error_m(flown_s, values["lon"] / 1e7, values["lat"] / 1e7)
    check(abs(values["alt"] - GROUND_AMSL_M - truth.agl_m) < 4 * max(1, values["vert_accuracy"]), str(values))
    return off_m, off_m / values["horiz_accuracy"]


def whole_flight(program):
    truth = program.truth
    send = ("--send", "gps_input,external_position_estimate,global_position_sensor")
    said, summary = program.fly_recorded(*send)
    check(repr(said) == repr(program.fly_recorded(*send)[0]), "the same flight says another thing the second time")
    beats = [values for _, number, values in said if number == 0]
    check(abs(len(beats) - (LEAD_S + SPACING_S * FRAMES)) <= 1, f"{len(beats)} heartbeats")
    check((beats[0]["type"], beats[0]["autopilot"], beats[0]["system_status"]) == (18, 8, 4), str(beats[0]))

    gps = [(flown_s, values) for flown_s, number, values in said if number == 232]
    with_fix = [(flown_s, values) for flown_s, values in gps if values["fix_type"] == 3]
    check(with_fix[0][0] < 2 and with_fix[-1][0] == gps[-1][0], f"a fix from {with_fix[0][0]} to {with_fix[-1][0]} s")
    intervals = [later[0] - earlier[0] for earlier, later in zip(gps, gps[1:])]
    check(max(intervals) < 0.2 and sum(intervals) / len(intervals) < 0.11, f"up to {max(intervals)} s between GPS_INPUTs")
    errors = [check_gps_input(truth, *message) for message in with_fix]
    check(max(error for error, _ in errors) < 12, f"{max(errors)} m off, in sigmas")
    within = sum(sigmas <= 2.45 for _, sigmas in errors) / len(errors)  # 95 % of a circular error
    check(within >= 0.9, f"only {within:.2f} within 95 % of what is said")

    sights = [(flown_s, values) for flown_s, number, values in said if number == 296]
    fixes = [(flown_s, values) for flown_s, values in sights if values["flags"] == 0]
    check(len(sights) == FRAMES and len(fixes) >= FRAMES // 2, f"{len(fixes)} fixes of {len(sights)} frames; {summary}")
    check(f"{FRAMES} frames tried, {len(fixes)} fixes taken, 0 refused" in summary, summary)
    for flown_s, values in fixes:
        exposure_s = flown_s - values["processing_time"] / 1e6
        check(abs(exposure_s / SPACING_S - round(exposure_s / SPACING_S)) < 1e-6, f"exposed at {exposure_s} s")
        off_m = truth.error_m(exposure_s, values["lon"] / 1e7, values["lat"] / 1e7)
        check(off_m < 4 * values["eph"] and off_m < 8, f"{off_m} m off: {values}")
        check((values["source"], values["id"], values["target_system"]) == (2, 1, 1) and math.isnan(values["alt_ellipsoid"]), str(values))
    for _, values in sights:
        check(values["flags"] == 0 or math.isnan(values["eph"]), f"PX4 passes over what has no eph: {values}")
    # Autopilots refuse it while GPS_INPUT has a fix.
    check(not any(number == 75 for _, number, _ in said), "43003 beside GPS_INPUT")


def camera_fails(program):
    """Pictures at the beginning and at the end: σ grows, "no fix" says so, and afterwards positions are commands."""
    truth = program.truth
    frames = [*range(6), *range(18, FRAMES)]
    said, _ = program.fly_recorded("--send", "gps_input,external_position_estimate", "--max-sigma-m", "12", frames=frames, height="terrain")
    blind = [(flown_s, values) for flown_s, number, values in said if number == 232 and
             LEAD_S + SPACING_S * 5 + 1 < flown_s < LEAD_S + SPACING_S * 18]
    sigmas = [values["horiz_accuracy"] for _, values in blind]
    check(sigmas == sorted(sigmas) and sigmas[-1] > 12, f"sigma from {sigmas[0]} to {sigmas[-1]} m without a picture")
    check(all((values["fix_type"] == 3) == (values["horiz_accuracy"] <= 12) for _, values in blind), "a fix beyond --max-sigma-m")
    check(any("no position: sigma" in text for text in texts(said)) and "Pilotage: GPS_INPUT is over after 5 s without" in texts(said), str(texts(said)))
    commands = [(flown_s, values) for flown_s, number, values in said if number == 75]
    check(len(commands) >= 2, f"{len(commands)} commands")
    for flown_s, values in commands:
        check(flown_s > LEAD_S + SPACING_S * 18 and (values["command"], values["frame"], values["target_component"]) == (43003, 0, 1), str(values))
        check(math.isnan(values["z"]) and abs(values["param1"] - flown_s) < 0.1 and 0 < values["param2"] < 0.5, str(values))
        check(truth.error_m(flown_s - values["param2"], values["y"] / 1e7, values["x"] / 1e7) < max(8, 4 * values["param3"]), str(values))
    late = [values["fix_type"] for flown_s, number, values in said if number == 232 and flown_s > commands[0][0]]
    check(set(late) == {1}, f"GPS_INPUT has begun anew: {late}")


def gps_inputs(said):
    return [(flown_s, values) for flown_s, number, values in said if number == 232]


def nothing_to_go_by(program):
    said, _ = program.fly_recorded("--send", "gps_input", silent=(20, 24), frames=range(10))
    check(any("no IMU: where it is, is not known" in text for text in texts(said)), str(texts(said)))
    after = [values["fix_type"] for flown_s, values in gps_inputs(said) if flown_s > 24]
    check(set(after) == {1}, f"a fix after the IMU was silent: {after}")

    said, _ = program.fly_recorded("--send", "gps_input", gnss_fix=1, frames=range(1))
    check({values["fix_type"] for _, values in gps_inputs(said)} == {1}, "it began without GNSS")
    said, _ = program.fly_recorded("--send", "gps_input", "--start-sigma-m", "30", gnss_fix=1, frames=[], seconds=3)
    first = next(values for _, values in gps_inputs(said) if values["fix_type"] == 3)
    check(29 < first["horiz_accuracy"] < 35, str(first))
    said, _ = program.fly_recorded("--send", "gps_input", h_acc_m=11, frames=[], seconds=3)
    first = next(values for _, values in gps_inputs(said) if values["fix_type"] == 3)
    check(10.9 < first["horiz_accuracy"] < 13, f"what the receiver states: {first}")

    _, summary = program.fly_recorded("--send", "gps_input", height="none", frames=range(3), seconds=14)
    check("0 frames tried" in summary and "3 without a height above ground" in summary, summary)
    _, summary = program.fly_recorded("--send", "gps_input", "--ground-amsl-m", str(GROUND_AMSL_M), height="none", frames=range(4), seconds=16)
    check("4 frames tried" in summary, summary)


def waits_for_the_first_fix(program):
    """With GNSS and without pictures it stays with the autopilot, however long, also after that was switched off and on."""
    said, _ = program.fly_recorded("--send", "gps_input", frames=[], leaves_truth_s=1e9, reboots_s=20, imu_ids=(2, 1))
    later = [(flown_s, values) for flown_s, values in gps_inputs(said) if flown_s > 27]
    check(all(values["fix_type"] == 3 and values["horiz_accuracy"] < 5 for _, values in later), f"{later[0]} … {later[-1]}")
    check(max(check_gps_input(program.truth, flown_s, values)[0] for flown_s, values in later) < 3, "it does not follow the autopilot")
    check(not any("is over" in text for text in texts(said)), str(texts(said)))


def does_not_begin_anew(program):
    """GNSS is lost before the first fix by sight: after five seconds without a position that fix comes too late for GPS_INPUT."""
    said, summary = program.fly_recorded("--send", "gps_input", "--max-sigma-m", "6", gnss_until_s=4, frames=range(12, FRAMES))
    check("0 fixes taken" not in summary, summary)
    gap = [flown_s for flown_s, values in gps_inputs(said) if flown_s > 4 and values["fix_type"] == 1]
    check(gap and all(values["fix_type"] == 1 for flown_s, values in gps_inputs(said) if flown_s > gap[0]), f"again after {gap[:1]}")
    check("Pilotage: GPS_INPUT is over after 5 s without" in texts(said), str(texts(said)))


def reckons_tilted(program):
    """Nose and wing up or down, climbing, GNSS lost after five seconds, no picture: what the IMU says is read by the right axes."""
    for pitch_deg, roll_deg, climb_mps in ((6, 4, 2), (-5, -8, -1)):
        said, _ = program.fly_recorded("--send", "gps_input", frames=[], seconds=22, gnss_until_s=5, pitch_deg=pitch_deg, roll_deg=roll_deg,
                                       climb_mps=climb_mps)
        for flown_s, values in gps_inputs(said):
            if values["fix_type"] != 3:
                continue
            off_m = program.truth.error_m(flown_s, values["lon"] / 1e7, values["lat"] / 1e7)
            check(off_m < 8 and off_m < 2.5 * values["horiz_accuracy"], f"{off_m} m off after {flown_s} s, pitch {pitch_deg}: {values}")
            high_m = values["alt"] - GROUND_AMSL_M - program.truth.agl_m - climb_mps * flown_s
            check(abs(high_m) < 3, f"{high_m} m too high after {flown_s} s")
        check(values["fix_type"] == 3 and values["horiz_accuracy"] > 8, str(values))


def bridges_a_hole(program):
    """Increments are missing for half a second: σ says what nobody measured, and fixes go on."""
    said, summary = program.fly_recorded("--send", "gps_input,global_position_sensor", silent=(15, 15.6))
    before = max(values["horiz_accuracy"] for flown_s, values in gps_inputs(said) if 14 < flown_s < 15)
    behind = [(flown_s, values) for flown_s, values in gps_inputs(said) if 15.75 < flown_s < 15.95]
    check(all(values["horiz_accuracy"] > before + 0.8 for _, values in behind), f"{before} m before, {behind}")
    late = [values for flown_s, number, values in said if number == 296 and flown_s > 17 and values["flags"] == 0]
    check(len(late) >= 14, f"{len(late)} fixes behind the hole; {summary}")
    check(all(values["fix_type"] == 3 for flown_s, values in gps_inputs(said) if flown_s > 1), "no fix at times")

    # A shorter one, with an exposure in its middle; attitudes are missing, too, and come back later.
    said, _ = program.fly_recorded("--send", "gps_input", silent=(13.8, 14.15), deaf=(13.8, 14.4), seconds=20, frames=[0, 1, 2, 3, 4])
    before = max(values["horiz_accuracy"] for flown_s, values in gps_inputs(said) if 13 < flown_s < 13.8)
    behind = [values["horiz_accuracy"] for flown_s, values in gps_inputs(said) if 14.6 < flown_s < 14.8]
    check(min(behind) > before + 0.5, f"{before} m before, {behind} behind")


def hears_refusals(program):
    said, summary = program.fly_recorded("--send", "external_position_estimate", refuses=True, frames=range(3), seconds=14)
    check("the autopilot refused 28 positions" in summary and "Pilotage: 43003 is refused, MAV_RESULT 4" in texts(said), summary + str(texts(said)))
    check(sum(number == 75 for _, number, _ in said) >= 2, "43003 by itself")
    check(sum("43003" in text for text in texts(said)) == 2, "the same again within ten seconds")


def live(program, link, receive, send, seconds):
    """The flight in real time. Returns what was received as (number, members), the summary, and when the flight began."""
    process = subprocess.Popen([program.example, program.map_path, "--unverified", "--link", link, "--send",
                                "gps_input,global_position_sensor", "--hold-back-ms", "500", "--deadline-ms", "20000"], stdin=subprocess.PIPE, stderr=subprocess.PIPE)
    received, wrong, ended = [], [], threading.Event()

    def listen():
        try:
            while not ended.is_set():
                received.extend(receive())
        except Exception as error:  # said by the other thread
            wrong.append(error)
    listener = threading.Thread(target=listen)
    listener.start()
    try:
        begin = time.time() + 0.5
        shown = 0
        for flown_s, frame in Told().words(program.truth, seconds):
            while shown < FRAMES and flown_s >= LEAD_S + SPACING_S * shown + 0.03:
                process.stdin.write(picture(program.rows[shown], round((begin + LEAD_S + SPACING_S * shown) * 1e6)))
                process.stdin.flush()
                shown += 1
            time.sleep(max(0, begin + flown_s - time.time()))
            send(frame)
        time.sleep(1)
        process.send_signal(signal.SIGTERM)
        _, summary = process.communicate(timeout=60)
    finally:
        process.kill()
        ended.set()
        listener.join()
    check(process.returncode == 0 and not wrong, f"{summary.decode()} {wrong}")
    return [(number, values) for _, _, _, _, number, values in received], summary.decode(), begin


def check_live(program, said, summary, begin):
    asked = {values["param1"]: values["param2"] for number, values in said if number == 76 and values["command"] == 511}
    check(asked.get(105) == 10000 and 24 in asked and 33 in asked, f"messages asked for: {asked}")
    check(any(number == 135 for number, _ in said), "the ground's height is not asked for")
    fixes = [values for number, values in said if number == 296 and values["flags"] == 0]
    check(len(fixes) >= 2 and "fixes taken" in summary and "from exposure to answer" in summary, f"{len(fixes)} fixes; {summary}")
    for values in fixes:
        exposure_s = (values["time_usec"] - values["processing_time"]) / 1e6 - begin
        check(abs(exposure_s / SPACING_S - round(exposure_s / SPACING_S)) < 1e-3, f"exposed at {exposure_s} s")
    errors = [check_gps_input(program.truth, values["time_usec"] / 1e6 - begin, values) for number, values in said
              if number == 232 and values["fix_type"] == 3]
    check(len(errors) > 20 and max(error for error, _ in errors) < 15, f"{len(errors)} positions, {max(errors)} m off")


def over_udp(program):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as autopilot:
        autopilot.bind(("127.0.0.1", 0))
        autopilot.settimeout(0.2)
        peer = []

        def receive():
            try:
                packet, sender = autopilot.recvfrom(1000)
            except TimeoutError:
                return []
            peer[:] = [sender]
            return [read_frame(packet)]

        def send(frame):
            if peer:
                autopilot.sendto(frame, peer[0])
        check_live(program, *live(program, f"udp:127.0.0.1:{autopilot.getsockname()[1]}", receive, send, 14))


def over_serial_line(program):
    """With noise on the line between frames."""
    master, slave = pty.openpty()
    tty.setraw(slave)
    rest = bytearray()

    def receive():
        if not select.select([master], [], [], 0.2)[0]:
            return []
        rest.extend(os.read(master, 4096))
        frames = []
        while len(rest) > 2 and len(rest) >= 12 + rest[1]:
            frames.append(read_frame(bytes(rest)))
            del rest[:frames[-1][0]]
        return frames
    noise = random.Random(2)

    def send(frame):
        os.write(master, frame + bytes(noise.randrange(256) for _ in range(noise.choice((0, 0, 0, 0, 3)))))
    try:
        check_live(program, *live(program, f"serial:{os.ttyname(slave)}:921600", receive, send, 14))
    finally:
        os.close(master)
        os.close(slave)


def wrong_arguments(program):
    arguments = [program.map_path, "--unverified", "--send", "gps_input"]
    for code, said, words in ((2, "one of --link and --recording", arguments), (2, "--rate-hz 2: a number from 5 to 20", [*arguments, "--rate-hz", "2"]),
                              (2, "--send gps: there are", [program.map_path, "--send", "gps"]), (1, "a link is udp:HOST:PORT", [*arguments, "--link", "tcp:1"]),
                              (1, "no such baud rate", [*arguments, "--link", "serial:/dev/null:9"]), (1, "cannot be read", [*arguments, "--recording", "none.tlog"]),
                              (2, "--sensor-id 1.5: a whole number", [*arguments, "--link", "udp:127.0.0.1:9", "--sensor-id", "1.5"]),
                              (2, "--hold-back-ms must be above", [*arguments, "--link", "udp:127.0.0.1:9", "--hold-back-ms", "20"]),
                              (1, "udpin:abc: no port", [*arguments, "--link", "udpin:abc"]), (1, "no recording of MAVLink", [*arguments, "--recording", program.map_path])):
        done, told = run(program.example, *words, expect=None)
        check(done == code and said in told, f"{words}: {done} {told}")


def test(pilotage, source, work, rest):
    cut, installed, *tools = rest
    if not (source / "maps/sample/ortho_second_epoch.tif").exists():
        print("skipped: the sample mission's imagery is not made: cmake --build … --target sample_mission")
        sys.exit(SKIP)
    check(crc_x25(b"123456789") == 0x6F91 and EXTRA == KNOWN_EXTRA, f"the definitions of this test: {EXTRA}")
    example = build_example(Toolchain(*tools), source, "autopilot", f"{installed}/onboard", work / "example")
    map_path = work / "map.gpkg"
    make_whole_map(pilotage, source / "maps/sample/ortho.tif", map_path, (FOOTPRINT_M,), CAMERA)
    route = {"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": ROUTE}}]}
    (work / "route.geojson").write_text(json.dumps(route))
    hfov_deg, width_px, height_px = CAMERA
    run(cut, source / "maps/sample/ortho_second_epoch.tif", "--hfov-deg", hfov_deg, "--width-px", width_px, "--height-px", height_px,
        "--footprint-m", FOOTPRINT_M, "--frames", FRAMES, "--format", "pgm", "--route", work / "route.geojson", "--max-tilt-deg", 0,
        "-o", work / "frames")
    with open(work / "frames/frames.csv", newline="") as stream:
        rows = [dict(row, file=work / "frames" / row["file"]) for row in csv.DictReader(stream)]
    program = Program(example, map_path, rows, Truth(rows), work)
    for part in (wrong_arguments, whole_flight, camera_fails, nothing_to_go_by, waits_for_the_first_fix, does_not_begin_anew, reckons_tilted, bridges_a_hole, hears_refusals, over_udp, over_serial_line):
        part(program)


main(test)
