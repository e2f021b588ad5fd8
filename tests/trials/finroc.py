#!/usr/bin/python3
"""Finroc's own tools in front of a bridge: builds them from their public sources and says what passed.

    tests/trials/finroc.py SOURCES [--bin build/release/bin] [--keep FOLDER] [--show finstruct|fingui]

SOURCES holds a checkout of each of Finroc's repositories, in a folder of its name:

    for name in NAMES; do git clone -b 17.03 https://github.com/finrocmirror/$name SOURCES/$name; done

NAMES are %s.
Nothing of them is part of Visum. Debian's openjdk-17-jdk, libxstream-java, libxpp3-java, libsvgsalamander-java and
libitext5-java are needed, and graphviz for the graphs of --show.

Runs Finroc's client libraries against `visum bridge finroc` and a daemon with the arm, first with the arm alone, then with a
controller above it. Their interface differs by branch: the claims are for 17.03. --show starts a window of the tool instead,
with the controller, and waits until it is closed; it also takes the older master. Exit code 0: all passed, 1: something
failed, 77: not possible here.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from programs import PATIENCE_S, SKIPPED, Daemon, Failed, FinrocBridge, NotHere, expect

HERE = Path(__file__).resolve().parent
REPOSITORIES = {  # and the package that each one is
    "finroc_core-java": "org/finroc/core",
    "finroc_plugins_tcp-java": "org/finroc/plugins/tcp",
    "finroc_plugins_data_types-java": "org/finroc/plugins/data_types",
    "finroc_plugins_blackboard-java": "org/finroc/plugins/blackboard",
    "finroc_tools_finstruct-java": "org/finroc/tools/finstruct",
    "finroc_tools_gui-java": "org/finroc/tools/gui",
    "rrlib_finroc_core_utils-java": "org/rrlib/finroc_core_utils",
    "rrlib_serialization-java": "org/rrlib/serialization",
    "rrlib_logging-java": "org/rrlib/logging",
    "rrlib_xml-java": "org/rrlib/xml",
}
PLUGINS = {  # jars that Finroc looks for by name, with the class that it starts
    "finroc_plugins_tcp": ("org/finroc/plugins/tcp", "org.finroc.plugins.tcp.internal.TCP"),
    "finroc_plugins_data_types": ("org/finroc/plugins/data_types", "org.finroc.plugins.data_types.DataTypePlugin"),
    "finroc_plugins_blackboard": ("org/finroc/plugins/blackboard", "org.finroc.plugins.blackboard.BlackboardPlugin"),
}
BLACKBOARD = {"BlackboardBuffer.java", "BlackboardPlugin.java"}  # all that its make.xml names
LIBRARIES = [Path("/usr/share/java") / jar for jar in ("xstream.jar", "xpp3.jar", "svgSalamander.jar", "itext5.jar")]
MAINS = {"finstruct": "org.finroc.tools.finstruct.Finstruct", "fingui": "org.finroc.tools.gui.FinrocGUI"}
# Finroc looks into Java's own classes. Without java.awt, fingui refuses to save a panel.
OPENED = ["java.management/sun.management", "java.base/java.lang", "java.base/java.lang.reflect", "java.base/java.util", "java.base/java.util.concurrent",
          "java.base/java.text", "java.desktop/java.awt", "java.desktop/java.awt.font", "java.desktop/java.awt.geom", "java.desktop/java.beans",
          "java.desktop/javax.swing"]
# A dialog for fonts that no distribution ships. Nothing here opens it.
FONT_CHOOSER = """package com.connectina.swing.fontchooser;
public class JFontChooser {
  public static java.awt.Font showDialog(java.awt.Window owner, java.awt.Font font) { return font; }
}
"""


def run(*words: object, cwd: Path | None = None) -> None:
    done = subprocess.run(list(map(str, words)), cwd=cwd, capture_output=True, text=True)
    expect(done.returncode == 0, f"{words[0]} failed:\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}")


def lay_out(sources: Path, folder: Path) -> list[Path]:
    """Puts the checkouts where Java expects packages. Returns the files to compile."""
    for name, package in REPOSITORIES.items():
        if not (sources / name).is_dir():
            raise NotHere(f"{sources} has no {name}")
        shutil.copytree(sources / name, folder / package, ignore=shutil.ignore_patterns(".git", ".hg"))
    stub = folder / "com/connectina/swing/fontchooser/JFontChooser.java"
    stub.parent.mkdir(parents=True)
    stub.write_text(FONT_CHOOSER)
    files = [path for path in folder.rglob("*.java") if "org/finroc/core/test" not in str(path)]
    return [path for path in files if "plugins/blackboard" not in str(path) or path.name in BLACKBOARD]


def build(sources: Path, folder: Path) -> None:
    """Compiles everything into jars as Finroc's own build names them."""
    if shutil.which("javac") is None or not all(library.exists() for library in LIBRARIES):
        raise NotHere("openjdk-17-jdk or a Java library of Debian is missing")
    code, classes = folder / "code", folder / "classes"
    classes.mkdir(parents=True)
    files = lay_out(sources, code)
    path = ":".join(map(str, LIBRARIES))
    (folder / "files").write_text("\n".join(map(str, files)))
    run("javac", "-encoding", "ISO-8859-1", "-nowarn", "-proc:none", "-d", classes, "-cp", path, f"@{folder / 'files'}")
    for resource in code.rglob("*"):
        if resource.suffix in (".png", ".svg", ".txt"):
            target = classes / resource.relative_to(code)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(resource, target)
    for jar, (package, start) in PLUGINS.items():
        (folder / "manifest").write_text(f"Plugin-Class: {start}\n")
        run("jar", "cfm", folder / f"{jar}.jar", folder / "manifest", "-C", classes, package)
        shutil.rmtree(classes / package)
    run("jar", "cf", folder / "finroc.jar", "-C", classes, ".")


def build_probe(folder: Path) -> None:
    try:
        run("javac", "-nowarn", "-d", folder, "-cp", class_path(folder), HERE / "finroc/Probe.java")
    except Failed as failure:
        raise NotHere(f"these sources are not of branch 17.03, whose libraries the claims use; --show works:\n{failure}") from failure


def class_path(folder: Path) -> str:
    return ":".join(map(str, [folder, *sorted(folder.glob("*.jar")), *LIBRARIES]))


@contextmanager
def controller(programs: Path, daemon: Daemon) -> Iterator[None]:
    """Hardware and motion, two parts in two processes, once a third one has moved the arm by them and ended."""
    running: list[subprocess.Popen[bytes]] = []
    try:
        for kind, lower in (("hardware", "arm"), ("motion", "hardware"), ("task", "motion")):
            words = [programs / f"visum-mca-{kind}", "--lower", f"{lower}@{daemon.address}", "--port", "0"]
            running.append(subprocess.Popen(list(map(str, words)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        expect(running[-1].wait(PATIENCE_S) == 0, "the uppermost part did not move the arm")
        yield
    finally:
        for process in reversed(running):
            process.terminate()
            process.wait(PATIENCE_S)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "") % " ".join(REPOSITORIES), formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sources", type=Path)
    parser.add_argument("--bin", type=Path, default=HERE.parents[1] / "build/release/bin")
    parser.add_argument("--keep", type=Path, help="build here, and do not build again what is there")
    parser.add_argument("--show", choices=MAINS)
    parser.add_argument("words", nargs="*", help="more words for the tool of --show, as a panel's file")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary) / "finroc"
        if not (folder / "finroc.jar").exists():
            build(options.sources, folder)
        if not options.show:
            build_probe(folder)
        with Daemon(options.bin, "--run") as daemon, FinrocBridge(options.bin, daemon) as bridge:
            java = ["java", *(word for package in OPENED for word in ("--add-opens", f"{package}=ALL-UNNAMED")), "-cp", class_path(folder)]
            address = f"localhost:{bridge.port}"
            if options.show:
                with controller(options.bin, daemon):
                    return subprocess.run([*java, MAINS[options.show], f"--connect={address}", *options.words], cwd=folder, check=False).returncode

            def probe(*words: str) -> int:
                return subprocess.run([*java, "Probe", address, *words], cwd=folder, check=False, timeout=600, env={**os.environ, "DISPLAY": ""}).returncode
            code = probe("arm")
            with controller(options.bin, daemon):
                return probe("motion/Arm/Trajectory", "motion/Blackboards/Way") or code


if __name__ == "__main__":
    try:
        sys.exit(main())
    except NotHere as reason:
        print(f"not possible here: {reason}")
        sys.exit(SKIPPED)
    except Failed as failure:
        print(failure)
        sys.exit(1)
