"""Copies a map database with one bit of one descriptor flipped, as a failing disk would: the byte in the file, not
through SQLite. Usage: flip_descriptor_byte.py MAP COPY"""

import sqlite3
import sys

source, copy = sys.argv[1:]
with sqlite3.connect(f"file:{source}?mode=ro", uri=True) as connection:
    (blob,) = connection.execute("SELECT descriptors FROM pilotage_descriptors ORDER BY tile_id LIMIT 1").fetchone()
with open(source, "rb") as stream:
    content = bytearray(stream.read())
# A piece short enough to lie on one page, found in the file as it is.
piece = blob[40:72]
assert content.count(piece) == 1, "the descriptor does not stand in the file once"
content[content.find(piece) + 7] ^= 0x10
with open(copy, "wb") as stream:
    stream.write(content)
