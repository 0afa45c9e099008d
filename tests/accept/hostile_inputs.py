"""Inputs that others wrote: what they name is not fetched, what is too large or no file is refused at once.

hostile_inputs.py PILOTAGE SOURCE_FOLDER

A server on loopback stands for the network: without --allow-network it must not see one request, whatever names it."""

import functools
import http.server
import json
import os
import resource
import subprocess
import threading

from acceptance import check, main, need_gdal

gdal = need_gdal()
import numpy as np  # noqa: E402
from osgeo import osr  # noqa: E402

MOST_KIB = 500 << 10
MOST_S = 60  # hung, not slow

RAW_BAND = """<VRTDataset rasterXSize="10" rasterYSize="10"><SRS>EPSG:32633</SRS>
<GeoTransform>500000, 1, 0, 5000000, 0, -1</GeoTransform>
<VRTRasterBand dataType="Byte" band="1" subClass="VRTRawRasterBand"><SourceFilename relativetoVRT="0">/etc/passwd</SourceFilename>
<ImageOffset>0</ImageOffset><PixelOffset>1</PixelOffset><LineOffset>10</LineOffset></VRTRasterBand></VRTDataset>
"""

WEB_MAP = """<GDAL_WMS><Service name="TMS"><ServerUrl>{url}/${{z}}/${{x}}/${{y}}.png</ServerUrl></Service>
<DataWindow><UpperLeftX>-20037508.34</UpperLeftX><UpperLeftY>20037508.34</UpperLeftY><LowerRightX>20037508.34</LowerRightX>
<LowerRightY>-20037508.34</LowerRightY><TileLevel>2</TileLevel><TileCountX>1</TileCountX><TileCountY>1</TileCountY>
<YOrigin>top</YOrigin></DataWindow><Projection>EPSG:3857</Projection><BlockSizeX>256</BlockSizeX><BlockSizeY>256</BlockSizeY>
<BandsCount>3</BandsCount><Cache /></GDAL_WMS>
"""


class Canary(http.server.ThreadingHTTPServer):
    """Remembers every request, and serves a folder."""

    def __init__(self, folder):
        self.requests = []
        canary = self

        class Handler(http.server.SimpleHTTPRequestHandler):

            def log_message(self, *_):
                pass

            def parse_request(self):
                canary.requests.append(str(self.raw_requestline))
                return super().parse_request()

        super().__init__(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder)))
        self.url = f"http://127.0.0.1:{self.server_port}"
        threading.Thread(target=self.serve_forever, daemon=True).start()


def make_raster(path, side=300, options=()):
    spatial = osr.SpatialReference()
    spatial.ImportFromEPSG(32633)
    dataset = gdal.GetDriverByName("GTiff").Create(str(path), side, side, 1, gdal.GDT_Byte, list(options))
    dataset.SetProjection(spatial.ExportToWkt())
    dataset.SetGeoTransform([500000, 1, 0, 5000000, 0, -1])
    if side < 10000:
        dataset.GetRasterBand(1).WriteArray(np.random.default_rng(1).integers(0, 255, (side, side), dtype=np.uint8))
    dataset = None


def vrt_of(source, relative=0, size=300):
    return (f'<VRTDataset rasterXSize="{size}" rasterYSize="{size}"><SRS>EPSG:32633</SRS>'
            '<GeoTransform>500000, 1, 0, 5000000, 0, -1</GeoTransform><VRTRasterBand dataType="Byte" band="1"><SimpleSource>'
            f'<SourceFilename relativeToVRT="{relative}">{source}</SourceFilename><SourceBand>1</SourceBand>'
            '</SimpleSource></VRTRasterBand></VRTDataset>\n')


class Program:

    def __init__(self, program, folder):
        self.program, self.folder = str(program), folder
        self.environment = dict(os.environ, AWS_NO_SIGN_REQUEST="YES", GDAL_HTTP_TIMEOUT="5", GDAL_HTTP_CONNECTTIMEOUT="5")

    def __call__(self, *arguments, expect, says="", limits=()):
        """Returns what it said, and the most memory that it took, KiB."""
        def limit():
            for kind, value in limits:
                resource.setrlimit(kind, (value, value))

        output = self.folder / "said.txt"
        with open(output, "wb") as stream:
            child = subprocess.Popen([self.program, *arguments], cwd=self.folder, stdout=stream, stderr=stream,
                                     env=self.environment, preexec_fn=limit)
            timer = threading.Timer(MOST_S, child.kill)
            timer.start()
            _, status, usage = os.wait4(child.pid, 0)
            timer.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        text = output.read_text(errors="backslashreplace")
        line = " ".join(os.fsdecode(part) for part in arguments).encode(errors="backslashreplace").decode()
        check(expect is None or child.returncode == expect, f"{line}: exit {child.returncode}, not {expect}\n{text[-2000:]}")
        check(says in text, f'{line}: does not say "{says}"\n{text[-2000:]}')
        return text, usage.ru_maxrss


def network(run, folder, canary):
    """Every way to the network that a name or a file may take."""
    port = canary.server_port
    web = folder / "web"
    web.mkdir()
    make_raster(folder / "served.tif")
    (web / "map.xml").write_text(WEB_MAP.format(url=canary.url))
    (web / "map.tif").write_text(WEB_MAP.format(url=canary.url))
    (web / "renamed.tif").write_text(vrt_of(f"/vsicurl/{canary.url}/served.tif"))
    (web / "nested.vrt").write_text(vrt_of("renamed.tif", 1))
    (web / "of_map.vrt").write_text(vrt_of("map.tif", 1, 256))
    (web / "inline.vrt").write_text(vrt_of("&lt;GDAL_WMS/&gt;"))
    (web / "zip.vrt").write_text(vrt_of(f"/vsizip//vsicurl/{canary.url}/a.zip/a.tif"))
    (web / "warped.vrt").write_text(
        '<VRTDataset rasterXSize="300" rasterYSize="300" subClass="VRTWarpedDataset"><VRTRasterBand dataType="Byte" band="1" '
        f'subClass="VRTWarpedRasterBand"/><GDALWarpOptions><SourceDataset relativeToVRT="0">/vsicurl/{canary.url}/served.tif'
        '</SourceDataset></GDALWarpOptions></VRTDataset>')
    for name in ("overviews.tif", "mapped.tif"):
        make_raster(web / name)
    for name, target in (("overviews.tif", f"/vsicurl/{canary.url}/served.tif"), ("mapped.tif", WEB_MAP.format(url=canary.url))):
        target = target.replace("<", "&lt;")
        (web / (name + ".aux.xml")).write_text(f'<PAMDataset><Metadata domain="OVERVIEWS"><MDI key="OVERVIEW_FILE">{target}</MDI>'
                                               "</Metadata></PAMDataset>")
    off = "--allow-network"
    named = [f"/vsicurl/{canary.url}/served.tif", f"/vsicurl?url={canary.url}/served.tif", f"/vsicurl_streaming/{canary.url}/served.tif",
             f"{canary.url}/served.tif", f"/vsizip//vsicurl/{canary.url}/a.zip/a.tif", f"/vsizip/{{/vsicurl/{canary.url}/a.zip}}/a.tif",
             "/vsis3/bucket/served.tif", f"GTIFF_DIR:1:/vsicurl/{canary.url}/served.tif", f"vrt:///vsicurl/{canary.url}/served.tif",
             f"WMS:{canary.url}/?SERVICE=WMS", f"WMTS:{canary.url}/wmts.xml", f"NETCDF:{canary.url}/a.nc:a"]
    for name in named:
        run("inspect", name, "--kind", "imagery", expect=1, says=off)
    for name in ("map.xml", "map.tif"):
        run("inspect", f"web/{name}", "--kind", "imagery", expect=1, says=off)
    for name in ("renamed.tif", "nested.vrt", "inline.vrt", "zip.vrt", "warped.vrt"):
        run("inspect", f"web/{name}", "--kind", "imagery", expect=1, says="--allow-any-vrt")
        run("score", f"web/{name}", "--allow-any-vrt", "-o", "s.tif", expect=1)
    run("score", "web/of_map.vrt", "-o", "s.tif", expect=1)
    for name in ("overviews.tif", "mapped.tif"):
        run("score", f"web/{name}", "--gsd-m", "4", "--tile-size-px", "32", "-o", "s.tif", "--overwrite", expect=0)
    run("inspect", f"PG:host=127.0.0.1 port={port} dbname=a", "--kind", "imagery", expect=1)
    run("score", "served.tif", "--gsd-m", "2", "--crs", f"{canary.url}/crs.wkt", "-o", "s.tif", "--overwrite", expect=2, says="is not a CRS")
    run("inspect", "MEM:::DATAPOINTER=4096,PIXELS=100,LINES=100", "--kind", "imagery", expect=1, says="cannot be opened")
    # Every command that reads imagery, and files that only name it.
    mission = {"imagery": [f"/vsicurl/{canary.url}/served.tif"], "route": "route.geojson", "agl_m": 100}
    (folder / "route.geojson").write_text('{"type":"LineString","coordinates":[[15.0005,45.153],[15.003,45.152]]}')
    (folder / "mission.json").write_text(json.dumps(mission))
    for command in ("tile", "prepare"):
        run(command, "mission.json", "--camera-hfov-deg", "60", "--camera-width-px", "640", "--camera-height-px", "480", "-o", "out",
            expect=1, says=off)
    mission["allow_network"] = True
    (folder / "mission.json").write_text(json.dumps(mission))
    run("tile", "mission.json", "-o", "plan.json", expect=2, says="allow_network")
    (folder / "frames.csv").write_text("file,time_s,prior_lon_deg,prior_lat_deg,prior_sigma_m,height_agl_m,yaw_deg,pitch_deg,roll_deg,"
                                       f"true_lon_deg,true_lat_deg\n/vsicurl/{canary.url}/served.tif,0,15,45,10,100,0,0,0,15,45\n")
    run("compare", f"/vsicurl/{canary.url}/served.tif", "--frames", "frames.csv", "--camera-hfov-deg", "60", "--camera-width-px", "640",
        "--camera-height-px", "480", "-o", "c.csv", expect=1, says=off)
    run("compare", "served.tif", "--frames", "frames.csv", "--camera-hfov-deg", "60", "--camera-width-px", "640",
        "--camera-height-px", "480", "-o", "c.csv", expect=None)
    check(not canary.requests, f"the network was asked: {canary.requests[:5]}")
    check(not (folder / "gdalwmscache").exists(), "gdalwmscache was left")
    run("inspect", named[0], "--allow-network", "--kind", "imagery", expect=0, says="300")
    check(canary.requests, "--allow-network allows nothing")
    run("score", "web/map.tif", "--allow-network", "-o", "m.tif", expect=None)
    check(not (folder / "gdalwmscache").exists(), "gdalwmscache was left with --allow-network")


def vrts(run, folder):
    """VRTs read what lies in their folder, and nothing else unless asked."""
    (folder / "mosaic/tiles").mkdir(parents=True)
    make_raster(folder / "mosaic/tiles/a.tif")
    make_raster(folder / "outside.tif")
    write = lambda name, text: (folder / "mosaic" / name).write_text(text)  # noqa: E731
    write("inside.vrt", vrt_of("tiles/a.tif", 1))
    write("tiles/back.vrt", vrt_of("../tiles/a.tif", 1))
    write("twice.vrt", vrt_of("tiles/back.vrt", 1))
    run("inspect", "mosaic/inside.vrt", expect=0)
    run("inspect", "mosaic/twice.vrt", expect=0, says="300")
    run("inspect", "vrt://mosaic/inside.vrt?bands=1", "--kind", "imagery", expect=0)
    write("raw.vrt", RAW_BAND)
    write("raw.tif", RAW_BAND)
    write("of_raw.vrt", vrt_of("raw.tif", 1, 10))
    write("absolute.vrt", vrt_of(folder / "outside.tif"))
    write("above.vrt", vrt_of("../outside.tif", 1))
    write("vsi.vrt", vrt_of(f"/vsisubfile/0_1000000,{folder}/outside.tif"))
    write("prefix.vrt", vrt_of(f"GTIFF_DIR:1:{folder}/outside.tif"))
    (folder / "mosaic/link.tif").symlink_to(folder / "outside.tif")
    write("linked.vrt", vrt_of("link.tif", 1))
    bad = ["raw.vrt", "raw.tif", "of_raw.vrt", "absolute.vrt", "above.vrt", "vsi.vrt", "prefix.vrt", "linked.vrt"]
    for name in bad:
        run("inspect", f"mosaic/{name}", "--kind", "imagery", expect=1, says="--allow-any-vrt")
        run("inspect", f"mosaic/{name}", "--kind", "imagery", "--allow-any-vrt", expect=0)
    run("inspect", vrt_of(folder / "outside.tif").strip(), "--kind", "imagery", expect=1, says="--allow-any-vrt")
    gdal.GetDriverByName("ISIS2").CreateCopy(str(folder / "other.cub"), gdal.Open(str(folder / "outside.tif")))
    run("inspect", "other.cub", "--kind", "imagery", expect=1, says="--gdal-driver ISIS2")
    run("inspect", "other.cub", "--kind", "imagery", "--gdal-driver", "ISIS2", expect=0, says="other.cub: ISIS2")
    run("inspect", "outside.tif", "--gdal-driver", "NoSuch", expect=2, says="NoSuch")


def small(run, *arguments, expect=1, says=""):
    _, kib = run(*arguments, expect=expect, says=says)
    check(kib < MOST_KIB, f"{arguments}: {kib} KiB")


def sizes(run, folder):
    """Refused before memory is taken."""
    make_raster(folder / "sparse.tif", 1000000, ["SPARSE_OK=TRUE", "TILED=YES", "BLOCKXSIZE=4096", "BLOCKYSIZE=4096", "BIGTIFF=YES"])
    small(run, "score", "sparse.tif", "-o", "sizes.tif", says="do not fit in memory")
    gdal.GetDriverByName("JPEG").CreateCopy(str(folder / "small.jpg"), gdal.Open(str(folder / "outside.tif")))
    picture = bytearray((folder / "small.jpg").read_bytes())
    at = picture.index(b"\xff\xc0") + 5  # height and width in the frame header
    picture[at:at + 4] = (65500).to_bytes(2, "big") * 2
    (folder / "large.jpg").write_bytes(picture)
    small(run, "inspect", "large.jpg", "--kind", "imagery", says="has no georeference")
    (folder / "large.jgw").write_text("1\n0\n0\n-1\n500000\n5000000\n")
    small(run, "score", "large.jpg", "--imagery-crs", "EPSG:32633", "-o", "sizes.tif", says="gdal_translate -co TILED=YES")
    line = np.linspace(45, 46, 1200000)
    (folder / "many.gpx").write_text('<?xml version="1.0"?><gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>' +
                                     "".join(f'<trkpt lat="{y:.6f}" lon="15"/>' for y in line) + "</trkseg></trk></gpx>")
    (folder / "many.geojson").write_text('{"type":"LineString","coordinates":[' + ",".join(f"[15,{y:.6f}]" for y in line) + "]}")
    (folder / "many.kml").write_text('<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><LineString><coordinates>' +
                                     " ".join(f"15,{y:.6f}" for y in line) + "</coordinates></LineString></Placemark></Document></kml>")
    (folder / "many.plan").write_text('{"fileType":"Plan","mission":{"items":[' + ",".join(
        '{"params":[0,0,0]}' for _ in line) + "]}}")
    (folder / "many.waypoints").write_text("QGC WPL 110\n" + "0\n" * 1200000)
    for name in ("many.gpx", "many.geojson", "many.kml", "many.plan", "many.waypoints"):
        small(run, "inspect", name, says="a route at most 100000")
    (folder / "huge.geojson").write_bytes(b" " * (65 << 20))
    small(run, "inspect", "huge.geojson", says="are allowed")


def pipes(run, folder):
    """What is no file is refused, and never waited for."""
    os.mkfifo(folder / "pipe")
    for suffix in (".tif", ".gpkg", ".geojson", ".csv", ".json", ".yaml", ".pub", ".minisig"):
        os.mkfifo(folder / ("pipe" + suffix))
    for name in ("pipe", "pipe.tif", "pipe.gpkg", "pipe.geojson", "/dev/zero", "/vsizip/pipe/a.tif", "GTIFF_DIR:1:pipe"):
        run("inspect", name, expect=1)
    run("inspect", "pipe.tif", expect=1, says="is a pipe or a device")
    run("score", "pipe.tif", "-o", "pipes.tif", expect=1, says="is a pipe")
    run("score", "pipe.json", "-o", "pipes.tif", expect=1, says="is a pipe")
    run("verify", "pipe.gpkg", expect=1)
    run("match", "pipe.gpkg", "--frames", "pipe.csv", expect=1)
    run("tile", "pipe.json", "-o", "p.json", expect=1, says="is a pipe")
    run("inspect", "outside.tif", "--config", "pipe.json", expect=1, says="is a pipe")
    run("compare", "outside.tif", "--frames", "pipe.csv", "--camera", "pipe.yaml", "-o", "c.csv", expect=1, says="is a pipe")
    run("verify", "outside.tif", "--public-key", "pipe.pub", expect=2)
    (folder / "piped.vrt").write_text(vrt_of("pipe.tif", 1))
    run("inspect", "piped.vrt", expect=1, says="is a pipe")
    (folder / "beside").mkdir()
    make_raster(folder / "beside/a.tif")
    os.mkfifo(folder / "beside/a.tif.msk")
    run("inspect", "beside/a.tif", expect=1, says="a.tif.msk: is a pipe")


def bytes_in_names(run, folder):
    """Names are bytes; JSON says them as UTF-8, and reads them back."""
    odd = os.fsencode(folder) + b"/caf\xe9 \xff"
    os.mkdir(odd)
    make_raster(folder / "plain.tif")
    os.rename(folder / "plain.tif", odd + b"/a\xfe.tif")
    raster = b"caf\xe9 \xff/a\xfe.tif"
    said, _ = run("inspect", raster, "--json", expect=0)
    check(json.loads(said)["dataset"] == "caf\\xe9 \\xff/a\\xfe.tif", said)
    run("inspect", raster, expect=0, says="caf\\xe9 \\xff/a\\xfe.tif: GTiff")
    run("inspect", b"missing\xff.tif", "--json", expect=1, says="missing\\xff.tif")
    score = ("--tile-size-px", "64", "--stride-px", "64", "--search-radius-px", "16")
    run("score", raster, *score, "-o", b"caf\xe9 \xff/s.tif", "--table", b"caf\xe9 \xff/t\xfd.csv", "--json", expect=0)
    run("score", raster, *score, "--shard", "1/1", "--shards", b"parts\xfc", "--json", expect=0)
    run("merge", b"parts\xfc", "-o", b"m\xfb.tif", expect=0)
    mission = {"imagery": ["a\\xfe.tif"], "route": "r\\xf0.geojson", "agl_m": 100, "speed_mps": 18,
               "camera": {"hfov_deg": 40, "width_px": 640, "height_px": 480}}
    with open(odd + b"/mission.json", "w", encoding="utf-8") as stream:
        json.dump(mission, stream)
    with open(odd + b"/r\xf0.geojson", "w", encoding="utf-8") as stream:
        stream.write(json.dumps({"type": "LineString", "coordinates": middle_of_raster()}))
    run("prepare", b"caf\xe9 \xff/mission.json", "-o", b"out\xf1", "--outputs", "html,json,gpkg,kmz,kml,geojson,cog", "--json", expect=0)
    run("score", b"out\xf1/plan.json", "-o", b"s\xf2.tif", "--table", b"t\xf2.csv", expect=0)
    run("verify", b"out\xf1/map.gpkg", expect=0)
    run("inspect", b"out\xf1/map.gpkg", "--json", expect=0)
    for name in (b"plan.json", b"report.json", b"selection.json"):
        with open(os.fsencode(folder) + b"/out\xf1/" + name, encoding="utf-8") as stream:
            json.load(stream)


def middle_of_raster():
    utm, wgs84 = osr.SpatialReference(), osr.SpatialReference()
    utm.ImportFromEPSG(32633)
    wgs84.ImportFromEPSG(4326)
    for spatial in (utm, wgs84):
        spatial.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    transform = osr.CoordinateTransformation(utm, wgs84)
    return [list(transform.TransformPoint(500000.0 + x, 4999850.0)[:2]) for x in (100, 200)]


def memory(run, folder):
    """Memory that runs out is told as such, whoever asked for it."""
    for mib in (250, 300, 350, 400, 500, 600, 800):
        said, _ = run("score", "outside.tif", "--tile-size-px", "64", "-o", "s.tif", "--overwrite", "--json", expect=None,
                      limits=((resource.RLIMIT_AS, mib << 20),))
        check('"internal"' not in said and "Traceback" not in said, f"{mib} MiB: {said[-1500:]}")
        if '"kind"' in said and '"memory"' in said:
            check("not enough memory" in said, said)


def test(program, _source, folder, _rest):
    run = Program(program, folder)
    network(run, folder, Canary(folder))
    for part in (vrts, sizes, pipes, bytes_in_names, memory):
        part(run, folder)


main(test)
