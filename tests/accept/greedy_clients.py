"""The server answers who asks little, whatever others ask: two clients that ask for images and never fetch them, two that ask for
sixteen images again and again, and one that asks for one; then SIGTERM while images are being drawn.

greedy_clients.py PILOTAGE SOURCE_FOLDER

What the honest one waited, what memory the server took, and how long it took to end are printed. Of the clock's times only those
fail that are out of all reason: a loaded machine decides nothing. The memory is a promise."""

import pathlib
import signal
import socket
import subprocess
import sys
import threading
import time

from acceptance import check, main, run

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "data"))
from airsim_script import address_of, pack, unpack  # noqa: E402

MAX_CLOCK_S = 20
MAX_MEMORY_MIB = 600
ROUNDS_S = 10
IMAGE = {"camera_name": "bottom_center", "image_type": 0, "pixels_as_float": False, "compress": False}


class Client:
    def __init__(self, address):
        self.socket = socket.create_connection(address, timeout=120)
        self.stream = self.socket.makefile("rb")
        self.number = 0

    def send(self, method, *arguments):
        self.number += 1
        self.socket.sendall(pack([0, self.number, method, list(arguments)]))

    def call(self, method, *arguments):
        self.send(method, *arguments)
        kind, number, error, result = unpack(self.stream)
        check((kind, number, error) == (1, self.number, None), f"{method}: {kind} {number} {error}")
        return result

    def seconds(self, method, *arguments):
        begin = time.monotonic()
        self.call(method, *arguments)
        return time.monotonic() - begin


def be_greedy(address, ended):
    """Fetches what it asked for, as fast as it comes, and asks again."""
    client = Client(address)
    try:
        while not ended.is_set():
            images = client.call("simGetImages", [IMAGE] * 16, "", False)
            check(len(images) == 16, "images are missing")
    except (OSError, IndexError):
        check(ended.is_set(), "the server closed a connection that fetches its answers")


def peak_mib(pid):
    lines = pathlib.Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmHWM")).split()[1]) / 1024


def greedy_clients(pilotage, source, work, _):
    sample = source / "maps/sample"
    run(pilotage, "tile", sample / "mission.json", "-q", "-o", work / "plan.json")
    server = subprocess.Popen([pilotage, "simulate", work / "plan.json", "--serve", "127.0.0.1:0", "--world",
                               sample / "ortho_second_epoch.tif", "--progress", "json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True)
    try:
        address = address_of(server)
        threading.Thread(target=server.stderr.read, daemon=True).start()
        honest = Client(address)
        honest.call("simPause", True)
        level = {"w_val": 1, "x_val": 0, "y_val": 0, "z_val": 0}
        honest.call("simSetVehiclePose", {"position": {"x_val": 0, "y_val": 0, "z_val": -120.0}, "orientation": level}, True, "")
        slow = [Client(address) for _ in range(2)]
        for client in slow:
            for _ in range(40):
                client.send("simGetImages", [IMAGE] * 16, "", False)
        ended = threading.Event()
        greedy = [threading.Thread(target=be_greedy, args=(address, ended), daemon=True) for _ in range(2)]
        for thread in greedy:
            thread.start()
        time.sleep(1)
        pings, images = [], []
        end = time.monotonic() + ROUNDS_S
        while time.monotonic() < end:
            pings.append(honest.seconds("ping"))
            images.append(honest.seconds("simGetImages", [IMAGE], "", False))
        memory_mib = peak_mib(server.pid)
        ended.set()
        begin = time.monotonic()
        server.send_signal(signal.SIGTERM)
        words = server.stdout.read()
        check(server.wait(timeout=60) == 0, f"exit {server.returncode}: {words}")
        end_s = time.monotonic() - begin
    finally:
        server.kill()
    print(f"honest client: {len(pings)} rounds, a ping took {max(pings):.2f} s at most, an image {max(images):.2f} s; "
          f"memory {memory_mib:.0f} MiB; {end_s:.2f} s from SIGTERM to the end")
    check(max(*pings, *images, end_s) < MAX_CLOCK_S, "out of all reason")
    check(memory_mib <= MAX_MEMORY_MIB, f"more than {MAX_MEMORY_MIB} MiB")


if __name__ == "__main__":
    main(greedy_clients)
