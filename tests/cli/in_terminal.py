"""Runs a command with a terminal of 80 columns as its standard error (and output, with --both) and prints what it drew.

in_terminal.py [--both] COMMAND...

One line for each time that something was drawn ("\\r" begins a line anew), escapes shown as "^[", and in the end
"left: " with what still stands in the terminal's last line. The exit code is the command's."""

import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios


def main():
    command = sys.argv[1:]
    both = command[0] == "--both"
    terminal, end = pty.openpty()
    fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    process = subprocess.Popen(command[both:], stdin=subprocess.DEVNULL, stdout=end if both else None, stderr=end)
    os.close(end)
    drawn = b""
    while True:
        try:
            piece = os.read(terminal, 65536)
        except OSError:  # how Linux says that nobody holds the other end
            break
        if not piece:
            break
        drawn += piece
    text = drawn.decode().replace("\r\n", "\n")
    for line in text.replace("\r", "\n").split("\n"):
        print(line.replace("\x1b", "^["))
    # "\r" goes to the beginning of the line, "erase to the end" clears it there.
    print("left: " + text.split("\n")[-1].split("\r")[-1].replace("\x1b[K", ""))
    raise SystemExit(process.wait())


main()
