#!/usr/bin/python3
"""Checks the promises of the Dockerfile and compose.yaml, as far as that is possible without Docker.

    container.py rules PREFIX   all that they name is there (packages, files, programs, the scene), and they ask
                                for no rights
    container.py run PREFIX     the installed daemon runs as the image's would: user 65534, no capabilities, no
                                new privileges, a read-only root but for /tmp, a network of its own; its health
                                check passes, and it ends

Exit code 77: `run` needs root.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

import yaml

SOURCE = Path(__file__).resolve().parents[2]
DOCKER = SOURCE / "docker"
SKIPPED = 77
NOBODY = "65534:65534"
ROOM = Path("/mnt")  # holds the installed files in the test's root
PATIENCE_S = 60.0


def instructions() -> dict[str, list[str]]:
    """The Dockerfile's instructions by name: those of its last stage, but COPY and RUN of all stages."""
    text = re.sub(r"\\\n", " ", re.sub(r"^#.*\n", "", (DOCKER / "Dockerfile").read_text(), flags=re.M))
    found: dict[str, list[str]] = {}
    for line in filter(None, map(str.strip, text.splitlines())):
        word, rest = line.split(maxsplit=1)
        found.setdefault(word, []).append(rest)
    return found


def expect(holds: object, claim: str) -> None:
    if not holds:
        sys.exit(f"container: {claim}")


def health_check(image: dict[str, list[str]]) -> str:
    return image["HEALTHCHECK"][-1].split("CMD", 1)[1].strip()


# Rules ---------------------------------------------------------------------------------------------------


def packages_are_there(file: Path) -> None:
    for line in file.read_text().splitlines():
        if not (entry := line.split("#")[0].strip()):
            continue
        name, _, command = entry.partition(" ")
        known = subprocess.run(["dpkg-query", "-W", "-f", "${Status}", name], capture_output=True, text=True).stdout
        there = "install ok installed" in known
        if command and not there:
            there = subprocess.run(["sh", "-c", f"command -v {command.strip('[]')}"], capture_output=True).returncode == 0
        expect(there, f"{file.name} names '{name}', which is not installed here: is it a package of Debian 12?")


def rules(prefix: Path) -> None:
    image = instructions()
    for copied in image["COPY"]:
        *sources, _ = shlex.split(copied)
        for source in sources if not copied.startswith("--from") else []:
            expect((SOURCE / source).exists(), f"the Dockerfile copies '{source}', which is not there")
    used = set(re.findall(r"docker/\S+\.txt", " ".join(image["RUN"] + image["COPY"])))
    expect(used == {"docker/packages.txt"}, f"the image installs from {used}, not from packages.txt alone")
    packages_are_there(DOCKER / "packages.txt")
    recommended = re.search(r'CPACK_DEBIAN_PACKAGE_RECOMMENDS "(.*)"', (DOCKER / "packaging.cmake").read_text())
    missing = set(recommended.group(1).split(", ")) - set(image["RUN"][-1].split())
    expect(not missing, f"the image lacks {missing}, which the package's scenarios need")
    expect(image["USER"] == [NOBODY], f"the image runs as {image.get('USER')}")
    (entry,) = json.loads(image["ENTRYPOINT"][-1])
    for program in (entry, shlex.split(health_check(image))[0]):
        expect((prefix / "bin" / program).is_file(), f"'{program}' is not installed")
    workdir = prefix / Path(image["WORKDIR"][-1]).relative_to("/usr")
    (scene,) = json.loads(image["CMD"][-1])
    expect((workdir / scene).is_file(), f"'{scene}' is not in {workdir}")
    said = subprocess.run([prefix / "bin" / entry, "--help"], capture_output=True, text=True).stdout
    for port in image["EXPOSE"][-1].split():
        expect(re.search(rf"\b{port}\b", said), f"port {port} is exposed, and not one of {entry}")
    service = yaml.safe_load((DOCKER / "compose.yaml").read_text())["services"]["visumd"]
    wanted = {"user": NOBODY, "read_only": True, "cap_drop": ["ALL"], "security_opt": ["no-new-privileges:true"]}
    expect({key: service.get(key) for key in wanted} == wanted, f"compose.yaml gives more rights than {wanted}")
    expect(all(str(port).startswith("127.0.0.1:") for port in service["ports"]), "compose.yaml opens a port to others")


# Run -----------------------------------------------------------------------------------------------------


def as_nobody(*words: str) -> list[str]:
    user, group = NOBODY.split(":")
    return ["setpriv", "--reuid", user, "--regid", group, "--clear-groups", "--no-new-privs", "--inh-caps", "-all",
            "--bounding-set", "-all", "env", "-i", f"PATH={ROOM}/bin:/usr/bin:/bin", "HOME=/tmp", "sh", "-c",
            f'cd {ROOM}/share/visum && exec "$@"', "sh", *words]


def in_the_container(prefix: Path) -> None:
    image = instructions()
    for words in (["mount", "--bind", prefix, ROOM], ["mount", "-o", "remount,bind,ro", ROOM], ["mount", "-o", "remount,bind,ro", "/"],
                  ["mount", "-t", "proc", "proc", "/proc"],
                  ["mount", "-t", "tmpfs", "-o", "noexec,nosuid,nodev,size=64m", "tmpfs", "/tmp"], ["ip", "link", "set", "lo", "up"]):
        subprocess.run(list(map(str, words)), check=True)
    for path in ("/usr/x", f"{ROOM}/x", "/var/x", "/x"):
        expect(subprocess.run(as_nobody("touch", path), capture_output=True).returncode != 0, f"{path} can be written")
    daemon = subprocess.Popen(as_nobody(*json.loads(image["ENTRYPOINT"][-1]), *json.loads(image["CMD"][-1])))
    until = time.monotonic() + PATIENCE_S
    while subprocess.run(as_nobody("sh", "-c", health_check(image)), capture_output=True).returncode != 0:
        expect(daemon.poll() is None, f"visumd ended with {daemon.returncode}")
        expect(time.monotonic() < until, "the health check does not pass")
        time.sleep(0.05)
    rights = dict(line.split(":\t", 1) for line in Path(f"/proc/{daemon.pid}/status").read_text().splitlines() if ":\t" in line)
    for name, value in {"Uid": "\t".join(["65534"] * 4), "CapEff": "0" * 16, "CapBnd": "0" * 16, "NoNewPrivs": "1"}.items():
        expect(rights[name] == value, f"{name} is {rights[name]}, not {value}")
    daemon.terminate()
    expect(daemon.wait(PATIENCE_S) == 0, f"visumd ended with {daemon.returncode} when it was told to")
    print("healthy as user 65534 without capabilities on a read-only root; ends when told to")


def run(prefix: Path) -> None:
    if os.geteuid() != 0:
        print("SKIPPED: this needs root, for mounts and another user")
        sys.exit(SKIPPED)
    apart = ["unshare", "--mount", "--net", "--pid", "--fork", "--kill-child", "--propagation", "private"]
    if subprocess.run([*apart, "true"], capture_output=True).returncode != 0:
        print("SKIPPED: no namespaces here")
        sys.exit(SKIPPED)
    sys.exit(subprocess.run([*apart, sys.executable, __file__, "inside", str(prefix)]).returncode)


def main() -> None:
    steps = {"rules": rules, "run": run, "inside": in_the_container}
    expect(len(sys.argv) == 3 and sys.argv[1] in steps, str(__doc__))
    steps[sys.argv[1]](Path(sys.argv[2]).resolve())


if __name__ == "__main__":
    main()
