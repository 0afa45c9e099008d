"""A run of `score` as a Slurm job array on two nodes, one of which dies while it works; merged, byte for byte the files
of a single run. Then a run of `capture`, matched in two shards: byte for byte the map of a single run.

slurm_array.py PILOTAGE SOURCE_FOLDER

Starts a controller and two nodes on loopback, each in a process namespace of its own: killing the first process of a
node kills all it runs at once, as a power failure would. The shard that the node was working on is caught in the act:
its program is stopped first, so that it cannot end before the node does. Needs root, Slurm and unshare."""

import ctypes
import filecmp
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

from acceptance import SKIP, check, main, need_gdal, run

gdal = need_gdal()
import numpy as np  # noqa: E402
from osgeo import osr  # noqa: E402

SHARDS = 4
PATIENCE_S = 240  # on a busy machine; alone it takes about half a minute
OPTIONS = ("--tile-size-px", "96", "--stride-px", "16", "--search-radius-px", "48")
NAMESPACE = ("unshare", "--pid", "--fork", "--kill-child", "--mount-proc")

CONFIGURATION = """
ClusterName=pilotage
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/linear
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,sched_min_interval=100000,batch_sched_delay=0
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=5
TCPTimeout=2
KillWait=2
MinJobAge=3600
NodeName=one NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1
NodeName=two NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIP)


def need_slurm():
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    for program in ("slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "unshare"):
        if not shutil.which(program):
            skip(f"{program} is not installed: apt-get install slurm-wlm util-linux")
    if os.geteuid() != 0:
        skip("a Slurm node that runs as somebody else cannot be started: run the tests as root")
    if subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False).returncode != 0:
        skip("process namespaces are not allowed here (unshare --pid): run the tests as root outside of a chroot or with CAP_SYS_ADMIN")
    for name in list(os.environ):  # of a cluster that this machine may belong to
        if name.startswith(("SLURM", "SBATCH", "PILOTAGE", "JOB_COMPLETION", "AWS_BATCH")):
            del os.environ[name]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def die_with_parent():
    set_parent_death_signal = 1  # PR_SET_PDEATHSIG: whatever ends this test ends the cluster
    ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL)


class Cluster:
    """A controller and the nodes "one" and "two"; all are gone when the with block ends."""

    def __init__(self, folder):
        self.folder = folder
        self.daemons = {}

    def __enter__(self):
        for name in ("state", "one", "two"):
            (self.folder / name).mkdir(parents=True)
        host = socket.gethostname().split(".")[0]
        configuration = self.folder / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(folder=self.folder, host=host, ports=free_ports(3)))
        os.environ["SLURM_CONF"] = str(configuration)
        self.start("controller", "slurmctld", "-D", "-i")
        self.start("one", "slurmd", "-D", "-N", "one")
        self.start("two", "slurmd", "-D", "-N", "two")
        return self

    def __exit__(self, *_):
        for name in list(self.daemons):
            self.kill(name)

    def start(self, name, *command):
        with open(self.folder / f"{name}.log", "w", encoding="utf-8") as log:
            self.daemons[name] = subprocess.Popen([*NAMESPACE, *command], stdin=subprocess.DEVNULL, stdout=log,
                                                  stderr=log, start_new_session=True, preexec_fn=die_with_parent)

    def kill(self, name):
        daemon = self.daemons.pop(name)
        daemon.kill()
        daemon.wait()

    def logs(self):
        return "".join(f"--- {log.name}\n{log.read_text(errors='replace')[-3000:]}\n"
                       for log in sorted(self.folder.glob("*.log")))


def wait_for(what, condition, until):
    """The first true value of condition()."""
    while time.monotonic() < until:
        if found := condition():
            return found
        time.sleep(0.02)
    check(False, f"{what}: not within {PATIENCE_S} s")


def make_ground(path):
    """Coarse structure and grain, the same on every machine, 900 x 700 px of half a metre."""
    random = np.random.default_rng(5)
    gray = 110 + sum(40 / 2**i * np.kron(random.standard_normal((700 // n + 1, 900 // n + 1)), np.ones((n, n)))[:700, :900]
                     for i, n in enumerate((64, 16, 4, 1)))
    dataset = gdal.GetDriverByName("GTiff").Create(str(path), 900, 700, 1, gdal.GDT_Byte)
    dataset.SetGeoTransform((500000, 0.5, 0, 5000000, 0, -0.5))
    reference = osr.SpatialReference()
    reference.ImportFromEPSG(32633)
    dataset.SetProjection(reference.ExportToWkt())
    dataset.GetRasterBand(1).WriteArray(np.clip(gray, 0, 255).astype(np.uint8))


def make_frames(ground, folder):
    """24 frames of 300 x 200 px, north up, cut from the ground side by side, and their table; the camera's options."""
    folder.mkdir()
    dataset = gdal.Open(str(ground))
    to_degrees = osr.CoordinateTransformation(osr.SpatialReference(dataset.GetProjection()), wgs84())
    lines = ["file,prior_lon_deg,prior_lat_deg,height_agl_m,yaw_deg,pitch_deg,roll_deg"]
    for y in range(0, 400, 100):
        for x in range(0, 700, 120):
            name = f"f{y}_{x}.png"
            gdal.Translate(str(folder / name), dataset, format="PNG", srcWin=[x, y, 300, 200])
            lon_deg, lat_deg, _ = to_degrees.TransformPoint(500000 + 0.5 * (x + 150), 5000000 - 0.5 * (y + 100))
            lines.append(f"{name},{lon_deg:.9f},{lat_deg:.9f},150,0,0,0")
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
    return "--camera-hfov-deg", "53.130102", "--camera-width-px", "300", "--camera-height-px", "200"


def wgs84():
    reference = osr.SpatialReference()
    reference.ImportFromEPSG(4326)
    reference.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return reference


def environment_of(process):
    try:
        pairs = (process / "environ").read_bytes().decode(errors="replace").split("\0")
        return dict(pair.split("=", 1) for pair in pairs if "=" in pair)
    except OSError:
        return {}


def stop_scoring_on(node, pilotage, folder):
    """Stops a `pilotage score` of the node that has begun and not ended; the number of its shard, or None."""
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if (process / "exe").resolve() != pilotage.resolve():
                continue
            number = environment_of(process).get("SLURM_ARRAY_TASK_ID")
            if environment_of(process).get("SLURMD_NODENAME") != node or number is None:
                continue
            if environment_of(process).get("SLURM_CONF") != os.environ["SLURM_CONF"]:
                continue  # another run of this test
            os.kill(int(process.name), signal.SIGSTOP)
            state = (process / "stat").read_text().rsplit(")", 1)[1].split()[0]
        except OSError:
            continue  # has ended
        if state in "Tt" and not shard_file(folder, int(number)).exists():
            return int(number)
        os.kill(int(process.name), signal.SIGCONT)
    return None


def shard_file(folder, number):
    return folder / f"scores-{number}-of-{SHARDS}.shard"


def job_field(job, name):
    found = re.search(rf"\b{name}=(\S+)", run("scontrol", "show", "job", job, expect=None)[1])
    return found.group(1) if found else ""


def start_what_waits():
    """Slurm lets a requeued job wait for two minutes; here nobody has to."""
    queue = run("squeue", "-h", "-O", "JobArrayID:40,State:20,Reason:40", expect=None)[1]
    for line in queue.splitlines():
        words = line.split()
        if len(words) == 3 and words[1:] == ["PENDING", "BeginTime"]:
            run("scontrol", "update", f"JobId={words[0]}", "StartTime=now", expect=None)


def test(pilotage, source, work, _):
    need_slurm()
    until = time.monotonic() + PATIENCE_S
    ground, parts = work / "ground.tif", work / "parts"
    make_ground(ground)
    os.environ["PILOTAGE"] = str(pilotage)
    with Cluster(work / "slurm") as cluster:
        try:
            wait_for("both nodes idle",
                     lambda: run("sinfo", "-h", "-N", "-o", "%T", expect=None)[1].split() == ["idle"] * 2, until)
            submitted = run(source / "tools/slurm/submit", SHARDS, parts, ground, *OPTIONS, "--", "-o", work / "merged.tif",
                            "--table", work / "merged.csv", cwd=work).split()
            check(submitted[0::2] == ["score", "merge"], f"submit said {submitted}")
            score, merge = submitted[1::2]

            shard = wait_for("a shard on node one", lambda: stop_scoring_on("one", pilotage, parts), until)
            cluster.kill("one")
            print(f"node one killed while it scored shard {shard}")
            check(not shard_file(parts, shard).exists(), "the killed task left a shard")

            def merged():
                start_what_waits()
                return job_field(merge, "JobState") not in ("PENDING", "RUNNING", "CONFIGURING", "COMPLETING", "")

            wait_for("the merge", merged, until)
            task = f"{score}_{shard}"
            check(job_field(task, "Restarts") != "0", f"task {task} was not requeued")
            check(job_field(task, "BatchHost") == "two", f"task {task} did not end on node two")
            log = (parts / f"score-{score}_{shard}.log").read_text()
            check("on one, restart 0" in log and "on two, restart 1" in log, f"log of the task:\n{log}")
            check(job_field(merge, "JobState") == "COMPLETED", f"merge: {job_field(merge, 'JobState')}\n" +
                  (parts / f"merge-{merge}.log").read_text())

            again = run(source / "tools/slurm/submit", SHARDS, parts, ground, *OPTIONS, "--", "-o", work / "again.tif",
                        cwd=work).split()
            wait_for("the second merge", lambda: job_field(again[3], "JobState") == "COMPLETED", until)
            logs = [(parts / f"score-{again[1]}_{i}.log").read_text() for i in range(1, SHARDS + 1)]
            check(all("done already" in log for log in logs), f"shards were scored again: {logs}")

            camera = make_frames(ground, work / "frames")
            (work / "mapped").mkdir()
            submitted = run(source / "tools/slurm/submit-capture", 2, work / "matches", work / "frames/frames.csv", *camera,
                            "--", "-o", work / "mapped/reference.tif", cwd=work).split()
            check(submitted[0::2] == ["match", "map"], f"submit-capture said {submitted}")
            wait_for("the map", lambda: job_field(submitted[3], "JobState") not in
                     ("PENDING", "RUNNING", "CONFIGURING", "COMPLETING", ""), until)
            check(job_field(submitted[3], "JobState") == "COMPLETED", f"map: {job_field(submitted[3], 'JobState')}\n" +
                  (work / f"matches/map-{submitted[3]}.log").read_text())
            logs = [(work / f"matches/match-{submitted[1]}_{i}.log").read_text() for i in (1, 2)]
            check(all("59 of 118 pairs" in log for log in logs), f"not half the pairs each: {logs}")
        except Exception:
            print(cluster.logs())
            raise

    run(pilotage, "score", ground, *OPTIONS, "-o", work / "whole.tif", "--table", work / "whole.csv", "-q")
    for whole, merged_file in (("whole.tif", "merged.tif"), ("whole.csv", "merged.csv"), ("whole.tif", "again.tif")):
        check(filecmp.cmp(work / whole, work / merged_file, shallow=False), f"{merged_file} is not {whole}")
    run(pilotage, "capture", work / "frames/frames.csv", *camera, "-o", work / "reference.tif", "-q")
    check(filecmp.cmp(work / "reference.tif", work / "mapped/reference.tif", shallow=False),
          "the map of two shards is not that of the single run")
    print(f"{SHARDS} shards on two nodes, one node killed: merged.tif and merged.csv are those of the single run; "
          "so is the map of frames that two shards matched")


if __name__ == "__main__":
    main(test)
