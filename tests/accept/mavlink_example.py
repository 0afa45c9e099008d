"""The example program of docs/examples/mavlink, built against an installed onboard library: what it sends over UDP is read
here by MAVLink's definitions, with a checksum of its own.

mavlink_example.py PILOTAGE SOURCE_FOLDER INSTALLED GENERATOR CXX LAUNCHER SANITIZERS"""

import math
import socket
import struct
import subprocess

from acceptance import check, main, run
from library_user import Toolchain, build_example

# Types and names as they stand on the wire: by size, then in the order of the definition in common.xml.
MESSAGES = {
    0: ("HEARTBEAT", ("uint32_t custom_mode", "uint8_t type", "uint8_t autopilot", "uint8_t base_mode",
                      "uint8_t system_status", "uint8_t mavlink_version")),
    296: ("GLOBAL_POSITION_SENSOR", ("uint64_t time_usec", "uint32_t processing_time", "int32_t lat", "int32_t lon",
                                     "float alt_ellipsoid", "float alt", "float eph", "float epv",
                                     "uint8_t target_system", "uint8_t target_component", "uint8_t id",
                                     "uint8_t source", "uint8_t flags")),
}
CODES = {"uint64_t": "Q", "uint32_t": "I", "int32_t": "i", "float": "f", "uint8_t": "B"}


def crc_x25(data, crc=0xFFFF):
    """Bit by bit, polynomial 0x1021 reflected; the example goes byte by byte."""
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0x8408 if crc & 1 else crc >> 1
    return crc


def crc_extra(name, fields):
    crc = crc_x25("".join(f"{word} " for word in (name, *" ".join(fields).split())).encode())
    return (crc & 0xFF) ^ (crc >> 8)


def read_frame(packet):
    """(sequence, system, component, message id, values by name) of a packet that holds one frame."""
    check(packet[0] == 0xFD and packet[2] == packet[3] == 0, packet.hex())
    size = packet[1]
    check(len(packet) == 10 + size + 2, packet.hex())
    message = int.from_bytes(packet[7:10], "little")
    name, fields = MESSAGES[message]
    crc = crc_x25(bytes([crc_extra(name, fields)]), crc_x25(packet[1:10 + size]))
    check(packet[10 + size:] == crc.to_bytes(2, "little"), f"checksum of {packet.hex()} is {crc:04x}")
    layout = "<" + "".join(CODES[field.split()[0]] for field in fields)
    check(size == 1 or packet[9 + size] != 0, f"{packet.hex()}: zeros at the payload's end are to be left out")
    payload = packet[10:10 + size].ljust(struct.calcsize(layout), b"\0")
    values = dict(zip((field.split()[1] for field in fields), struct.unpack(layout, payload)))
    return packet[4], packet[5], packet[6], message, values


def send(example, lines):
    """Frames that come for the lines, and what the example says."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(60)
        done = subprocess.run([example, "127.0.0.1", str(receiver.getsockname()[1])], input="\n".join(lines) + "\n",
                              capture_output=True, text=True)
        good = len(lines) if done.returncode == 0 else 0
        return done, [read_frame(receiver.recv(1000)) for _ in range(2 * good)]


def test(pilotage, source, work, rest):
    del pilotage
    installed, *tools = rest
    example = build_example(Toolchain(*tools), source, "mavlink", f"{installed}/onboard", work / "example")
    check(crc_x25(b"123456789") == 0x6F91, "this test's own checksum")
    check(run(example, "--check").strip() == "6F91", run(example, "--check"))
    # As the generated headers have them: MAVLINK_MSG_ID_…_CRC.
    check([crc_extra(*MESSAGES[number]) for number in (0, 296)] == [50, 158], "CRC_EXTRA of the definitions")

    done, frames = send(example, ["16.501279 55.497373 4.5 152.25", "-179.9999999 -33.5 1 nan", "none"])
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    check([frame[:4] for frame in frames] == [(i, 1, 191, 296 if i % 2 else 0) for i in range(6)], str(frames))
    beat = frames[0][4]
    check((beat["type"], beat["autopilot"], beat["system_status"], beat["mavlink_version"]) == (18, 8, 4, 3), str(beat))
    first, second, none = (frames[i][4] for i in (1, 3, 5))
    check((first["lat"], first["lon"]) == (554973730, 165012790), str(first))
    check((first["alt_ellipsoid"], first["eph"], first["epv"]) == (152.25, 4.5, 5), str(first))
    check(math.isnan(first["alt"]) and first["source"] == 2 and first["flags"] == 0, str(first))
    check(first["time_usec"] > 1.7e15 and first["processing_time"] == 0, str(first))
    check((second["lat"], second["lon"]) == (-335000000, -1799999999), str(second))
    check(math.isnan(second["alt_ellipsoid"]) and math.isnan(second["epv"]), str(second))
    check((none["lat"], none["lon"], none["flags"]) == (2**31 - 1, 2**31 - 1, 1), str(none))

    done, _ = send(example, ["16.5 east 4 nan"])
    check(done.returncode == 1 and "line 1 is neither" in done.stderr, done.stderr)
    code, words = run(example, "127.0.0.1", expect=None)
    check(code == 2, words)


main(test)
