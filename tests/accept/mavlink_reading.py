"""MAVLink, written and read by the definitions of its messages (common.xml): independent of the programs under test."""

import struct

from acceptance import check

# Types and names as they stand on the wire: by size, then in the order of the definition. Behind the bar: what MAVLink 2
# appended, which no checksum counts.
MESSAGES = {
    0: ("HEARTBEAT", "uint32_t custom_mode, uint8_t type, uint8_t autopilot, uint8_t base_mode, uint8_t system_status, "
                     "uint8_t mavlink_version"),
    24: ("GPS_RAW_INT", "uint64_t time_usec, int32_t lat, int32_t lon, int32_t alt, uint16_t eph, uint16_t epv, uint16_t vel, "
                        "uint16_t cog, uint8_t fix_type, uint8_t satellites_visible | int32_t alt_ellipsoid, uint32_t h_acc, "
                        "uint32_t v_acc, uint32_t vel_acc, uint32_t hdg_acc, uint16_t yaw"),
    30: ("ATTITUDE", "uint32_t time_boot_ms, float roll, float pitch, float yaw, float rollspeed, float pitchspeed, float yawspeed"),
    33: ("GLOBAL_POSITION_INT", "uint32_t time_boot_ms, int32_t lat, int32_t lon, int32_t alt, int32_t relative_alt, int16_t vx, "
                                "int16_t vy, int16_t vz, uint16_t hdg"),
    75: ("COMMAND_INT", "float param1, float param2, float param3, float param4, int32_t x, int32_t y, float z, uint16_t command, "
                        "uint8_t target_system, uint8_t target_component, uint8_t frame, uint8_t current, uint8_t autocontinue"),
    76: ("COMMAND_LONG", "float param1, float param2, float param3, float param4, float param5, float param6, float param7, "
                         "uint16_t command, uint8_t target_system, uint8_t target_component, uint8_t confirmation"),
    77: ("COMMAND_ACK", "uint16_t command, uint8_t result | uint8_t progress, int32_t result_param2, uint8_t target_system, "
                        "uint8_t target_component"),
    105: ("HIGHRES_IMU", "uint64_t time_usec, float xacc, float yacc, float zacc, float xgyro, float ygyro, float zgyro, float xmag, "
                         "float ymag, float zmag, float abs_pressure, float diff_pressure, float pressure_alt, float temperature, "
                         "uint16_t fields_updated | uint8_t id"),
    132: ("DISTANCE_SENSOR", "uint32_t time_boot_ms, uint16_t min_distance, uint16_t max_distance, uint16_t current_distance, "
                             "uint8_t type, uint8_t id, uint8_t orientation, uint8_t covariance | float horizontal_fov, "
                             "float vertical_fov, float[4] quaternion, uint8_t signal_quality"),
    135: ("TERRAIN_CHECK", "int32_t lat, int32_t lon"),
    136: ("TERRAIN_REPORT", "int32_t lat, int32_t lon, float terrain_height, float current_height, uint16_t spacing, "
                            "uint16_t pending, uint16_t loaded"),
    232: ("GPS_INPUT", "uint64_t time_usec, uint32_t time_week_ms, int32_t lat, int32_t lon, float alt, float hdop, float vdop, "
                       "float vn, float ve, float vd, float speed_accuracy, float horiz_accuracy, float vert_accuracy, "
                       "uint16_t ignore_flags, uint16_t time_week, uint8_t gps_id, uint8_t fix_type, uint8_t satellites_visible | "
                       "uint16_t yaw"),
    253: ("STATUSTEXT", "uint8_t severity, char[50] text | uint16_t id, uint8_t chunk_seq"),
    296: ("GLOBAL_POSITION_SENSOR", "uint64_t time_usec, uint32_t processing_time, int32_t lat, int32_t lon, float alt_ellipsoid, "
                                    "float alt, float eph, float epv, uint8_t target_system, uint8_t target_component, uint8_t id, "
                                    "uint8_t source, uint8_t flags"),
}
CODES = {"uint64_t": "Q", "uint32_t": "I", "int32_t": "i", "uint16_t": "H", "int16_t": "h", "float": "f", "uint8_t": "B",
         "float[4]": "16s", "char[50]": "50s"}


def crc_x25(data, crc=0xFFFF):
    """Bit by bit, polynomial 0x1021 reflected."""
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0x8408 if crc & 1 else crc >> 1
    return crc


def fields_of(number):
    """(type, name) of a message's members, and how many of them the checksum counts."""
    base, _, extension = MESSAGES[number][1].partition("|")
    split = [[tuple(field.split()) for field in part.split(",") if field.strip()] for part in (base, extension)]
    return split[0] + split[1], len(split[0])


def crc_extra(number):
    fields, counted = fields_of(number)
    crc = crc_x25(f"{MESSAGES[number][0]} ".encode())
    for kind, name in fields[:counted]:
        element, _, length = kind.partition("[")
        crc = crc_x25(f"{element} {name} ".encode(), crc)
        if length:
            crc = crc_x25(bytes([int(length.rstrip("]"))]), crc)
    return (crc & 0xFF) ^ (crc >> 8)


EXTRA = {number: crc_extra(number) for number in MESSAGES}
LAYOUTS = {number: "<" + "".join(CODES[kind] for kind, _ in fields_of(number)[0]) for number in MESSAGES}
NAMES = {number: [name for _, name in fields_of(number)[0]] for number in MESSAGES}


def write_frame(number, sequence=0, system=1, component=1, version=2, **values):
    """Members that are not given are 0."""
    payload = struct.pack(LAYOUTS[number], *(values.get(name, b"" if name in ("text", "quaternion") else 0) for name in NAMES[number]))
    if version == 1:
        counted = struct.calcsize("<" + "".join(CODES[kind] for kind, _ in fields_of(number)[0][:fields_of(number)[1]]))
        head = bytes([counted, sequence % 256, system, component, number])
        payload = payload[:counted]
    else:
        payload = payload.rstrip(b"\0") or b"\0"
        head = bytes([len(payload), 0, 0, sequence % 256, system, component]) + number.to_bytes(3, "little")
    crc = crc_x25(bytes([EXTRA[number]]), crc_x25(head + payload))
    return bytes([0xFE if version == 1 else 0xFD]) + head + payload + crc.to_bytes(2, "little")


def read_frame(packet):
    """(bytes of the frame, sequence, system, component, message's number, members by name) of what begins with a frame of MAVLink 2."""
    check(packet[0] == 0xFD and packet[2] == packet[3] == 0, packet[:20].hex())
    end = 10 + packet[1]
    number = int.from_bytes(packet[7:10], "little")
    crc = crc_x25(bytes([EXTRA[number]]), crc_x25(packet[1:end]))
    check(packet[end:end + 2] == crc.to_bytes(2, "little"), f"checksum of {packet[:end + 2].hex()} is {crc:04x}")
    check(packet[1] == 1 or packet[end - 1] != 0, f"{packet[:end].hex()}: zeros at the payload's end are to be left out")
    payload = packet[10:end].ljust(struct.calcsize(LAYOUTS[number]), b"\0")
    return end + 2, packet[4], packet[5], packet[6], number, dict(zip(NAMES[number], struct.unpack(LAYOUTS[number], payload)))


def recorded(time_us, frame):
    """A frame as a .tlog has it."""
    return time_us.to_bytes(8, "big") + frame


def read_recording(data):
    """(time in µs, sequence, system, component, number, members) of the frames of MAVLink 2 in a .tlog."""
    at = 0
    while at < len(data):
        size, *said = read_frame(data[at + 8:])
        yield int.from_bytes(data[at:at + 8], "big"), *said
        at += 8 + size
