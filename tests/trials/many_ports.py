#!/usr/bin/python3
"""Measures the cost of showing many ports to one Finroc peer, end to end: a daemon with parts whose ports all change in
each tick, the bridge, and a peer that follows them.

    tests/trials/many_ports.py [--bin build/release/bin] [--ports 1000] [--hz 25] [--seconds 20] [--most 5]

Prints the rate at which the peer got each port, and the processor time in per cent of one core: of the bridge, and of
the daemon beyond what it needs without a peer. --most is the limit for the bridge; without it only the rate is judged.
Exit code 0: all holds, 1: something does not, 77: not possible here.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import programs
from programs import SOURCE, Daemon, FinrocBridge, NotHere, expect

sys.path.insert(0, str(SOURCE / "tests/clients/bridges"))
import finroc_peer as finroc  # noqa: E402

# A part that moves nothing, and whose outputs count its ticks.
PLUGIN = """
#include "protocol/plugin/plugin.h"
namespace {
class Counters final : public visum::plugin::Part {
 public:
  explicit Counters(visum::plugin::PartContext& scene) {
    const int ports = static_cast<int>(scene.settings().number("ports", 1, 4096));
    for (int i = 1; i <= ports; ++i) scene.add_output({"Counter " + std::to_string(i), "", 0.0, 1e12, 0.0, "Counter"});
  }
  void act(std::span<const double>, std::span<const visum::plugin::JointSample>,
           std::span<visum::plugin::JointDrive>) override { ++ticks_; }
  void publish(std::span<const visum::plugin::JointSample>, std::span<double> outputs) override {
    for (std::size_t i = 0; i < outputs.size(); ++i) outputs[i] = ticks_ + 0.001 * static_cast<double>(i);
  }
  void reset() override { ticks_ = 0.0; }
  void save(visum::plugin::StateOut& to) const override { to.put(ticks_); }
  void load(visum::plugin::StateIn& from) override { from.get(ticks_); }

 private:
  double ticks_ = 0.0;
};
constexpr visum::plugin::PartKind kParts[] = {{"counters", "ports that count ticks", visum::plugin::make_part<Counters>}};
}  // namespace
VISUM_PLUGIN({.name = "counters", .version = "1", .parts = kParts})
"""
PORTS_OF_A_PART = 100


def make_scene(folder: Path, ports: int) -> Path:
    (folder / "counters.cc").write_text(PLUGIN)
    if shutil.which("c++") is None:
        raise NotHere("there is no C++ compiler")
    subprocess.run(["c++", "-std=c++20", "-O2", "-shared", "-fPIC", "-I", SOURCE, folder / "counters.cc", "-o", folder / "counters.so"],
                   check=True)
    parts = [f"  - {{name: part_{first // PORTS_OF_A_PART}, kind: counters, ports: {min(PORTS_OF_A_PART, ports - first)}}}"
             for first in range(0, ports, PORTS_OF_A_PART)]
    scene = folder / "counters.yaml"
    scene.write_text("visum: 1\nname: counters\nplugins: [counters]\nparts:\n" + "\n".join(parts) + "\n")
    return scene


def processor_s(pid: int) -> float:
    """The processor time of the process with all its threads."""
    words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def follow(peer: finroc.Peer, seconds: float) -> dict[int, int]:
    """Takes in values for so long. Returns how many came of each port, by handle."""
    counts = {handle: 0 for handle in peer.seen}
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for code, data in peer.values.next_batch()[0]:
            if code == 10:
                counts[data.take("i") - 7] += 1
    return counts


def measure(options: argparse.Namespace, folder: Path) -> str:
    scene = make_scene(folder, options.ports)
    with Daemon(options.bin, "-r", "--http", "off", "--plugins", folder, scene=scene) as daemon, FinrocBridge(options.bin, daemon) as bridge:
        began = processor_s(daemon.pid)
        time.sleep(options.seconds)
        alone_s = processor_s(daemon.pid) - began
        with finroc.Peer(bridge.port) as peer:
            ports = [element for path, element in peer.by_path.items() if "/Sensor Output/Counter " in path]
            expect(len(ports) == options.ports, f"the bridge shows {len(ports)} of {options.ports} ports")
            peer.subscribe(*ports, interval_ms=round(1000 / options.hz))
            for port in ports:
                peer.wait_for(port, lambda value: True)
            before = processor_s(bridge.process.pid), processor_s(daemon.pid), time.monotonic()
            counts = follow(peer, options.seconds)
            took_s = time.monotonic() - before[2]
            bridge_s = processor_s(bridge.process.pid) - before[0]
            daemon_s = processor_s(daemon.pid) - before[1]
    slowest, fastest = (round(count / took_s, 1) for count in (min(counts.values()), max(counts.values())))
    share = 100 * bridge_s / took_s
    said = (f"{options.ports} ports, {slowest} to {fastest} values per second each; bridge {share:.2f} % of a core; daemon "
            f"{100 * daemon_s / took_s:.2f} %, without a peer {100 * alone_s / options.seconds:.2f} %")
    expect(slowest > 0.8 * options.hz, f"a port is too slow: {said}")
    expect(options.most is None or share < options.most, f"the bridge takes more than {options.most} %: {said}")
    return said


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/release/bin")
    parser.add_argument("--ports", type=int, default=1000)
    parser.add_argument("--hz", type=float, default=25)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--most", type=float, help="per cent of a core that the bridge may take")
    options = parser.parse_args()
    return programs.run_all({"many_ports": measure}, [], options)


if __name__ == "__main__":
    sys.exit(main())
