"""Starts `pilotage simulate … --serve 127.0.0.1:0`, asks what a script for AirSim asks, with a msgpack of its own, and
ends it by SIGTERM. Its exit code is that of the program.

airsim_script.py COMMAND..."""

import json
import math
import signal
import socket
import struct
import subprocess
import sys


def pack(value):
    """As old packers do: text for bytes, float64 for numbers."""
    if value is None:
        return b"\xc0"
    if isinstance(value, bool):
        return b"\xc3" if value else b"\xc2"
    if isinstance(value, int):
        return struct.pack(">Bq", 0xD3, value)
    if isinstance(value, float):
        return struct.pack(">Bd", 0xCB, value)
    if isinstance(value, str):
        data = value.encode()
        return struct.pack(">BH", 0xDA, len(data)) + data
    if isinstance(value, list):
        return struct.pack(">BH", 0xDC, len(value)) + b"".join(map(pack, value))
    return struct.pack(">BH", 0xDE, len(value)) + b"".join(pack(k) + pack(v) for k, v in value.items())


SIMPLE = {0xC0: None, 0xC2: False, 0xC3: True}
NUMBERS = {0xCA: ">f", 0xCB: ">d", 0xCC: ">B", 0xCD: ">H", 0xCE: ">I", 0xCF: ">Q", 0xD0: ">b", 0xD1: ">h", 0xD2: ">i",
           0xD3: ">q"}
SIZED = {0xC4: (">B", bytes), 0xC5: (">H", bytes), 0xC6: (">I", bytes), 0xD9: (">B", str), 0xDA: (">H", str),
         0xDB: (">I", str), 0xDC: (">H", list), 0xDD: (">I", list), 0xDE: (">H", dict), 0xDF: (">I", dict)}


def unpack(stream):
    def number(layout):
        return struct.unpack(layout, stream.read(struct.calcsize(layout)))[0]

    def sized(size, kind):
        if kind is list:
            return [unpack(stream) for _ in range(size)]
        if kind is dict:
            return {unpack(stream): unpack(stream) for _ in range(size)}
        data = stream.read(size)
        return data.decode() if kind is str else data

    first = stream.read(1)[0]
    if first in SIMPLE:
        return SIMPLE[first]
    if first in NUMBERS:
        return number(NUMBERS[first])
    if first in SIZED:
        return sized(number(SIZED[first][0]), SIZED[first][1])
    if first <= 0x7F:
        return first
    if first >= 0xE0:
        return first - 256
    return sized(first & (0x1F if first >= 0xA0 else 0x0F), str if first >= 0xA0 else list if first >= 0x90 else dict)


def address_of(server):
    """Where it serves, as its progress says."""
    for line in server.stderr:
        words = json.loads(line)["what"].split()
        if words[:3] == ["serving", "AirSim", "on"]:
            host, port = words[3].rsplit(":", 1)
            return host, int(port)
    sys.exit("the server ended before it served")


def ask(connection):
    stream = connection.makefile("rb")
    number = 0

    def call(method, *arguments):
        nonlocal number
        number += 1
        connection.sendall(pack([0, number, method, list(arguments)]))
        kind, replied, error, result = unpack(stream)
        assert (kind, replied) == (1, number) and error is None, (method, error)
        return result

    assert call("ping") is True
    version = call("getServerVersion")
    call("enableApiControl", True, "")
    call("simPause", True)
    level = {"w_val": 1, "x_val": 0, "y_val": 0, "z_val": 0}
    call("simSetVehiclePose", {"position": {"x_val": 0, "y_val": 0, "z_val": -60.0}, "orientation": level}, True, "")
    down_m = -call("simGetVehiclePose", "")["position"]["z_val"]
    request = {"camera_name": "bottom_center", "image_type": 0, "pixels_as_float": False, "compress": False}
    image, = call("simGetImages", [request], "", False)
    pixels = image["image_data_uint8"]
    assert len(pixels) == 3 * image["width"] * image["height"], len(pixels)
    assert len(set(pixels)) > 20, "the ground is of one gray"
    assert math.isfinite(call("getImuData", "", "")["linear_acceleration"]["z_val"])
    print(f"script: {image['width']} x {image['height']} pixels, at most {max(pixels)}, {version} version, "
          f"down {down_m:.1f} m")


def main():
    server = subprocess.Popen([*sys.argv[1:], "--progress", "json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True)
    try:
        with socket.create_connection(address_of(server), timeout=60) as connection:
            ask(connection)
    finally:
        server.send_signal(signal.SIGTERM)
        words, _ = server.communicate(timeout=60)
    print(words, end="")
    sys.exit(server.returncode)


if __name__ == "__main__":
    main()
