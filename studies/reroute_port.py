"""How often `reroute` makes a NO-GO line GO over a real port, and what that costs in length.

reroute_port.py PILOTAGE $PILOTAGE_DATA [HOW_MANY]

Straight lines of 350 to 700 m between points drawn with a fixed seed inside the imagery; the first ten (HOW_MANY) that
are NO-GO are rerouted. Low flight with a hobby's inertial system and a tight limit, so that there are NO-GO lines."""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

from osgeo import gdal, osr

gdal.UseExceptions()
MISSION = {"camera": {"hfov_deg": 60, "width_px": 4000, "height_px": 3000}, "ins": {"grade": "consumer"}, "agl_m": 70,
           "speed_mps": 15, "max_error_m": 40}


def lines(imagery):
    """Endless pairs of points, longitude and latitude, with imagery 60 m around each."""
    data = gdal.Open(str(imagery))
    place = data.GetGeoTransform()
    mask = data.GetRasterBand(1).GetMaskBand().ReadAsArray()
    reach = round(60 / place[1])
    wgs84 = osr.SpatialReference()
    wgs84.ImportFromEPSG(4326)
    wgs84.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    grid = data.GetSpatialRef()
    grid.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    to_wgs84 = osr.CoordinateTransformation(grid, wgs84)
    draw = random.Random(13)

    def point():
        while True:
            col, row = draw.randrange(reach, data.RasterXSize - reach), draw.randrange(reach, data.RasterYSize - reach)
            if mask[row - reach:row + reach:20, col - reach:col + reach:20].all():
                return place[0] + col * place[1], place[3] + row * place[5]

    while True:
        a, b = point(), point()
        if 350 <= math.dist(a, b) <= 700:
            yield [to_wgs84.TransformPoint(*end)[:2] for end in (a, b)]


def main(program, data, how_many):
    imagery = pathlib.Path(data) / "port/port_2019-08.tif"
    done = []
    looked_at = 0
    with tempfile.TemporaryDirectory() as folder:
        mission = pathlib.Path(folder) / "mission.json"
        mission.write_text(json.dumps({"imagery": [str(imagery)], **MISSION}))
        for start, end in lines(imagery):
            looked_at += 1
            run = subprocess.run([program, "reroute", mission, f"--from={start[0]:.7f},{start[1]:.7f}",
                                  f"--to={end[0]:.7f},{end[1]:.7f}", "--search-within-m", "600", "--json", "--overwrite",
                                  "-q", "-o", f"{folder}/new.plan"], capture_output=True, text=True)
            result = json.loads(run.stdout)
            if "error" in result:
                print("refused:", result["error"]["message"], flush=True)
                continue
            planned, new = result["planned"], result["new"]
            if planned["verdict"] != "NO-GO":
                continue
            done.append((planned, new))
            print(f"{len(done):2} {planned['verdict']} P {planned['p_within_limit']:.3f} {planned['length_m']:.0f} m -> "
                  f"{new['verdict']} P {new['p_within_limit']:.3f} {new['length_m']:.0f} m "
                  f"({new['length_m'] / planned['length_m'] - 1:+.0%}), {new['turns']} turns", flush=True)
            if len(done) == how_many:
                break
    go = [new["length_m"] / planned["length_m"] - 1 for planned, new in done if new["verdict"] == "GO"]
    print(f"{len(go)} of {len(done)} NO-GO lines of {looked_at} drawn made GO" +
          (f"; longer by {sum(go) / len(go):.0%} on average, {min(go):.0%} to {max(go):.0%}" if go else ""))


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) == 4 else 10)
