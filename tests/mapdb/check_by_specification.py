"""Reads a map with nothing but the two pages in schemas/ and the Python standard library, checks every digest and prints
the tiles and key points, so that the C++ reader can be compared with it.

  python3 check_by_specification.py map.gpkg
"""

import hashlib
import sqlite3
import struct
import sys


def text(value):
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<Q", len(data)) + data


def i64(*values):
    return struct.pack("<%dq" % len(values), *values)


def digest(data):
    return hashlib.blake2b(data, digest_size=32)


def value_bytes(value):
    if value is None:
        return b"N"
    if isinstance(value, int):
        return b"I" + i64(value)
    if isinstance(value, float):
        return b"F" + struct.pack("<d", value)
    if isinstance(value, str):
        return b"T" + text(value)
    return b"B" + text(value)


def section(name, cursor):
    names = [column[0] for column in cursor.description]
    yield b"T" + text(name) + struct.pack("<Q", len(names)) + b"".join(text(n) for n in names)
    for row in cursor:
        yield b"R" + b"".join(value_bytes(value) for value in row)


def content_digest(db):
    result = digest(b"pilotage map 1\n")
    schema = db.execute("SELECT type, name, tbl_name, sql FROM sqlite_master ORDER BY name, type")
    for part in section("sqlite_master", schema):
        result.update(part)
    tables = db.execute("SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage <> 0 ORDER BY name").fetchall()
    for (name,) in tables:
        where = " WHERE key <> 'content_digest'" if name == "map_info" else ""
        for part in section(name, db.execute('SELECT * FROM "%s"%s ORDER BY rowid' % (name, where))):
            result.update(part)
    return result.hexdigest()


def keypoint(data, base):
    low, height = struct.unpack("<Q", data)[0] & 0xFFFFFFFFFFFF, struct.unpack("<h", data[6:])[0]
    metres = None if height == -32768 else base + height / 10
    return (low & 0x1FFFFF) / 16, (low >> 21 & 0x1FFFFF) / 16, low >> 42, metres


def main(path):
    db = sqlite3.connect("file:%s?mode=ro&immutable=1" % path, uri=True)
    info = dict(db.execute("SELECT key, value FROM map_info ORDER BY id"))
    assert info["schema_version"] == "1"
    assert content_digest(db) == info["content_digest"], "content_digest"
    rows = db.execute(
        "SELECT tile_id, level, window_col_px, window_row_px, window_width_px, window_height_px, count, descriptor_bytes,"
        " ground_base_m, keypoints, descriptors, digest FROM pilotage_descriptors ORDER BY tile_id, level")
    for row in rows:
        base, keypoints, descriptors, stored = row[8:]
        flag = struct.pack("<Bd", base is not None, base or 0.0)
        data = b"pilotage descriptors 1\n" + i64(*row[:8]) + flag + text(keypoints) + text(descriptors)
        assert digest(data).digest() == stored, "descriptors of tile %d" % row[0]
        assert len(keypoints) == 8 * row[6] and len(descriptors) == row[6] * row[7]
        for i in range(row[6]):
            x, y, octave, height = keypoint(keypoints[8 * i:8 * i + 8], base)
            bits = sum(bin(byte).count("1") for byte in descriptors[row[7] * i:row[7] * (i + 1)])
            shown = "-" if height is None else "%.1f" % height
            print("%d %d %.4f %.4f %d %s %d" % (row[0], row[1], x, y, octave, shown, bits))
    if db.execute("SELECT 1 FROM sqlite_master WHERE name = 'pilotage_chips'").fetchone():
        for row in db.execute("SELECT tile_id, level, window_col_px, window_row_px, window_width_px, window_height_px,"
                              " encoding, data, digest FROM pilotage_chips ORDER BY tile_id, level"):
            data = b"pilotage chips 1\n" + i64(*row[:6]) + text(row[6]) + text(row[7])
            assert digest(data).digest() == row[8], "chip of tile %d" % row[0]


main(sys.argv[1])
