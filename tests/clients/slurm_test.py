"""visum campaign --on slurm, on a real Slurm of two nodes on this machine, of which one is lost in the middle."""
import json
import os
import pathlib
import secrets
import shutil
import signal
import socket
import subprocess
import tempfile
import textwrap
import time
import unittest

from campaign_test import SAMPLED
from programs import BIN, DEADLINE_S, processes_with, visum
from sweep_test import WORLD

PROGRAMS = ("slurmctld", "slurmd", "sbatch", "munged", "sinfo")

CONFIGURATION = """
    ClusterName=visum
    SlurmctldHost={host}(127.0.0.1)
    SlurmctldPort={ports[0]}
    SlurmUser=root
    SlurmdUser=root
    AuthType=auth/munge
    AuthInfo=socket={folder}/munge.sock,cred_expire=10
    CredType=cred/munge
    MpiDefault=none
    ProctrackType=proctrack/linuxproc
    TaskPlugin=task/none
    SelectType=select/cons_tres
    SelectTypeParameters=CR_Core
    JobAcctGatherType=jobacct_gather/none
    AccountingStorageType=accounting_storage/none
    SlurmdParameters=config_overrides
    ReturnToService=2
    SlurmdTimeout=5
    StateSaveLocation={folder}/state
    SlurmdSpoolDir={folder}/spool.%n
    SlurmctldPidFile={folder}/slurmctld.pid
    SlurmdPidFile={folder}/slurmd.%n.pid
    SlurmctldLogFile={folder}/slurmctld.log
    SlurmdLogFile={folder}/slurmd.%n.log
    SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0,sched_min_interval=0
    NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 State=UNKNOWN
    NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 State=UNKNOWN
    PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""


def missing_for_slurm():
    absent = [name for name in PROGRAMS if shutil.which(name) is None]
    if absent:
        return f"{', '.join(absent)} not found: install slurm-wlm and munge"
    return None if os.geteuid() == 0 else "only root can run munged and slurmd"


def free_ports(count):
    """Ports that nobody had a moment ago."""
    doors = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [door.getsockname()[1] for door in doors]
    for door in doors:
        door.close()
    return ports


def ended(condition, patience_s=DEADLINE_S):
    until = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > until:
            return False
        time.sleep(0.05)
    return True


class Cluster:
    """munged, slurmctld and two slurmd for the length of a `with`."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = {}
        self.env = {"SLURM_CONF": str(folder / "slurm.conf")}

    def __enter__(self):
        self.folder.mkdir()
        (self.folder / "state").mkdir()
        key = self.folder / "key"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o400)
        (self.folder / "slurm.conf").write_text(textwrap.dedent(CONFIGURATION).format(
            host=socket.gethostname(), folder=self.folder, ports=free_ports(3)))
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.sock",
                   f"--pid-file={self.folder}/munged.pid", f"--log-file={self.folder}/munged.log", f"--seed-file={self.folder}/seed")
        if not ended((self.folder / "munge.sock").exists):
            raise AssertionError("munged did not start")
        self.start("slurmctld", "-D")
        for node in ("n1", "n2"):
            self.start("slurmd", "-D", "-N", node)
        if not ended(lambda: self.states() == {"n1": "idle", "n2": "idle"}, 60):
            raise AssertionError(f"the nodes are {self.states()}")
        return self

    def start(self, *words):
        self.processes[words[-1] if words[0] == "slurmd" else words[0]] = subprocess.Popen(
            words, env={**os.environ, **self.env}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def states(self):
        told = subprocess.run(["sinfo", "-h", "-N", "-o", "%N %t"], env={**os.environ, **self.env}, capture_output=True,
                              text=True, timeout=DEADLINE_S)
        return dict(line.split() for line in told.stdout.splitlines())

    def jobs_on(self, node):
        """The processes of jobs on a node, and Slurm's own above them."""
        found = set()
        for folder in pathlib.Path("/proc").iterdir():
            try:
                if folder.name.isdigit() and f"SLURMD_NODENAME={node}\0".encode() in (folder / "environ").read_bytes():
                    found.add(int(folder.name))
                    parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
                    if "slurmstepd" in pathlib.Path(f"/proc/{parent}/comm").read_text():
                        found.add(parent)
            except OSError:
                pass  # it has ended meanwhile
        return found

    def lose(self, node):
        """As if the machine lost its power."""
        self.processes[node].kill()
        for process in self.jobs_on(node):
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def __exit__(self, *_):
        for process in reversed(self.processes.values()):
            process.kill()
            process.wait(timeout=DEADLINE_S)
        for process in processes_with(str(self.folder)):
            os.kill(process, signal.SIGKILL)


@unittest.skipIf(missing_for_slurm(), missing_for_slurm())
class Slurm(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_slurm_test_")))
        (self.folder / "world.yaml").write_text(textwrap.dedent(WORLD))
        self.file = self.folder / "scenario.yaml"

    def write(self, runs):
        self.file.write_text("visum_scenario: 1\nname: slide\nscene: world.yaml\n" +
                             textwrap.dedent(SAMPLED.replace("runs: 24", f"runs: {runs}")))

    def test_a_node_is_lost_and_the_report_is_the_same(self):
        self.write(200)
        here = json.loads(visum("campaign", self.file, "--report", self.folder / "here", "--json", "--jobs", 2, expect=1).stdout)
        with Cluster(self.folder / "cluster") as cluster:
            report = self.folder / "there"
            words = [BIN / "visum", "campaign", self.file, "--report", report, "--on", "slurm", "--shards", "8", "--json",
                     "--no-recordings"]
            there = subprocess.Popen(words, env={**os.environ, **cluster.env}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                     text=True)
            try:
                self.assertTrue(ended(lambda: cluster.jobs_on("n2") or there.poll() is not None))
                cluster.lose("n2")
                out, err = there.communicate(timeout=DEADLINE_S)
            finally:
                there.kill()
            self.assertEqual(there.returncode, 1, err)
            self.assertTrue(cluster.states()["n2"].startswith("down"), "the node is lost")
        merged = json.loads(out)
        for name in ("runs", "passed", "failed", "invalid", "hash", "checks"):
            self.assertEqual(merged[name], here[name])
        self.assertEqual((report / "results.csv").read_bytes(), (self.folder / "here" / "results.csv").read_bytes())

    def test_an_interrupt_cancels_the_job(self):
        self.write(2000)
        with Cluster(self.folder / "cluster") as cluster:
            words = [BIN / "visum", "campaign", self.file, "--report", self.folder / "there", "--on", "slurm", "--shards", "2"]
            there = subprocess.Popen(words, env={**os.environ, **cluster.env}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                     text=True)
            try:
                self.assertTrue(ended(lambda: cluster.jobs_on("n1") | cluster.jobs_on("n2")))
                there.send_signal(signal.SIGINT)
                there.communicate(timeout=DEADLINE_S)
            finally:
                there.kill()
            self.assertEqual(there.returncode, 130)
            self.assertTrue(ended(lambda: not (cluster.jobs_on("n1") | cluster.jobs_on("n2"))), "nothing runs on")


if __name__ == "__main__":
    unittest.main()
