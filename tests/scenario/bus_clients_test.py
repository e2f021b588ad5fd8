"""The arm's modules for programs that know nothing of Visum: a plain C program, pyserial, python-can over slcan."""

import json
import re
import signal
import struct
import subprocess
import tempfile
import time
import unittest
from contextlib import contextmanager
from pathlib import Path

import can
import serial

from programs import BIN

ARM = Path(__file__).resolve().parents[2] / "models" / "scenes" / "amtec_arm.yaml"
HOME_OK, MOTION, RAMP_END = 0x2, 0x800, 0x8000


@contextmanager
def daemon(*options: str):
    """A visumd that runs at once; its buses by part, as the ready line names them."""
    command = [BIN / "visumd", ARM, "--port", "0", "--json", "-v", "0", "--run", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield json.loads(process.stdout.readline())
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)


def frame(module: int, *data: int) -> bytes:
    body = [0x04 | module >> 3, (module & 7) << 5 | len(data), *data]
    total = sum(body)
    body.append((total + (total >> 8)) & 0xFF)
    escaped = b"".join(bytes([0x10, b + 0x80]) if b in (2, 3, 0x10) else bytes([b]) for b in body)
    return b"\x02" + escaped + b"\x03"


def unescape(wire: bytes) -> bytes:
    body, escaped = bytearray(), False
    for byte in wire[1:-1]:
        if byte == 0x10 and not escaped:
            escaped = True
            continue
        body.append(byte - 0x80 if escaped else byte)
        escaped = False
    return bytes(body[2:-1])


class OverSerial(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.tty = str(self.folder / "arm.tty")
        self.ready = self.enterContext(daemon("--bus", f"arm=pty:{self.tty}", "--speedup", "5"))

    def ask(self, line: serial.Serial, module: int, *data: int) -> bytes:
        line.write(frame(module, *data))
        return unescape(line.read_until(b"\x03"))

    def test_the_ready_line_names_the_bus(self) -> None:
        self.assertEqual(self.ready["buses"], {"arm": [f"pty:{self.tty}"]})

    def test_the_status_tells_clients_where_the_bus_is(self) -> None:
        connect = f"127.0.0.1:{self.ready['port']}"
        shown = subprocess.run([BIN / "visum", "status", "--connect", connect, "--json"], capture_output=True, check=True)
        self.assertEqual(json.loads(shown.stdout)["buses"], [{"part": "arm", "name": f"pty:{self.tty}"}])
        shown = subprocess.run([BIN / "visum", "status", "--connect", connect], capture_output=True, text=True, check=True)
        self.assertRegex(shown.stdout, rf"bus of arm +pty:{self.tty}\n")

    def test_pyserial_moves_a_module(self) -> None:
        with serial.Serial(self.tty, 38400, timeout=10) as line:
            self.assertEqual(self.ask(line, 1, 0x0A, 0x1D), bytes([0x0A, 0x1D, 0x34, 0x46]))
            self.assertEqual(self.ask(line, 1, 0x0B, 0x04, *struct.pack("<f", 0.2)), b"\x0b\x04\x64")
            state = MOTION
            while state & MOTION:
                (state,) = struct.unpack("<I", self.ask(line, 1, 0x0A, 0x27)[2:])
            self.assertEqual(state & 0xFFFF, HOME_OK | RAMP_END)
            (position,) = struct.unpack("<f", self.ask(line, 1, 0x0A, 0x3E)[2:])
            self.assertAlmostEqual(position, 0.2, places=6)

    def test_clients_come_and_go(self) -> None:
        for _ in range(20):
            with serial.Serial(self.tty, 9600, timeout=10) as line:
                self.assertEqual(self.ask(line, 8, 0x0A, 0x20), b"\x0a\x20\x08")

    def test_a_c_program_does_all_that_a_lab_does(self) -> None:
        done = subprocess.run([BIN / "visum-serial-arm", self.tty, "38400", "5"], capture_output=True, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("scan: 8 modules", done.stdout)
        self.assertIn("all well", done.stdout)
        home = float(re.search(r"home: ([0-9.]+) s", done.stdout)[1])
        self.assertGreater(home, 7.0, "joint 4 goes 1.6 rad with 0.2 rad/s")

    def test_the_c_program_says_what_it_cannot_open(self) -> None:
        for arguments in ([str(self.folder / "nothing")], [self.tty, "1234"], [], [self.tty, "38400", "0"]):
            done = subprocess.run([BIN / "visum-serial-arm", *arguments], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 2)
            self.assertTrue(done.stderr)


class OverSlcan(unittest.TestCase):
    def setUp(self) -> None:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.path = str(folder / "arm.can")
        self.enterContext(daemon("--bus", f"arm=slcan:{self.path}"))
        self.bus = can.interface.Bus(bustype="slcan", channel=self.path, bitrate=500_000, sleep_after_open=0)
        self.addCleanup(self.bus.shutdown)

    def ask(self, can_id: int, *data: int) -> bytes:
        self.bus.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=False))
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            answer = self.bus.recv(1)
            if answer:
                self.assertEqual(answer.arbitration_id, 0xA0 + (can_id & 0x1F))
                return bytes(answer.data)
        self.fail("no answer")

    def test_python_can_finds_all_modules(self) -> None:
        for module in range(1, 9):
            self.assertEqual(self.ask(0xC0 + module, 0x0A, 0x1D), bytes([0x0A, 0x1D, 0x34, 0x46]))

    def test_extended_commands_are_answered_with_position_and_state(self) -> None:
        answer = self.ask(0xE1, 0x0B, 0x0E, *struct.pack("<f", 0.1))
        position, short, _dio = struct.unpack("<fBB", answer[2:])
        self.assertAlmostEqual(position, 0.0, places=3)
        self.assertEqual(short, 0x10)


class WithoutTheHardware(unittest.TestCase):
    def refused(self, bus: str) -> str:
        command = [BIN / "visumd", ARM, "--port", "0", "--bus", bus]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2)
        return done.stderr

    def test_mistakes_are_named(self) -> None:
        self.assertIn("did you mean 'arm'", self.refused("amr=pty:x"))
        self.assertIn("pty, tcp, slcan, socketcan", self.refused("arm=rs232:x"))
        self.assertIn("/nowhere/arm.tty", self.refused("arm=pty:/nowhere/arm.tty"))
        self.assertIn("no TCP port", self.refused("arm=tcp:99999"))

    def test_a_kernel_without_can_is_named(self) -> None:
        if "AF_CAN" not in (text := self.refused("arm=socketcan:visum0")):
            self.skipTest("this kernel has AF_CAN: " + text)


if __name__ == "__main__":
    unittest.main(verbosity=2)
