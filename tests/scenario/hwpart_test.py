"""visum-hwpart with a bus that is not as it should be."""

from __future__ import annotations

import contextlib
import signal
import socket
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path

from programs import BIN
from served_arm import ARM, PATIENCE_S, real_arm, virtual_arm, wait_until

import visum

READY, HALTED, FAULT = 0, 4, 5
COMM_ERROR = 0x20


class Cable:
    """A TCP line between visum-hwpart and the modules that can be pulled and plugged in again."""

    def __init__(self, port: int) -> None:
        self.modules = port
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.plugged = True
        self.ends: list[socket.socket] = []
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            try:
                near, _ = self.listener.accept()
            except OSError:
                return
            if not self.plugged:
                near.close()
                continue
            far = socket.create_connection(("127.0.0.1", self.modules))
            self.ends += [near, far]
            for a, b in ((near, far), (far, near)):
                threading.Thread(target=self._carry, args=(a, b), daemon=True).start()

    @staticmethod
    def _carry(source: socket.socket, sink: socket.socket) -> None:
        try:
            while data := source.recv(4096):
                sink.sendall(data)
        except OSError:
            pass

    def pull(self) -> None:
        self.plugged = False
        for end in self.ends:
            with contextlib.suppress(OSError):  # the other side may be gone already
                end.shutdown(socket.SHUT_RDWR)
            end.close()
        self.ends.clear()

    def plug(self) -> None:
        self.plugged = True

    def close(self) -> None:
        self.pull()
        self.listener.close()


class OnACable(unittest.TestCase):
    def setUp(self) -> None:
        self.world = self.enterContext(virtual_arm("--bus", "arm=tcp:0"))
        self.cable = Cable(int(self.world.ready["buses"]["arm"][0].split(":")[1]))
        self.addCleanup(self.cable.close)

    def serve(self, *options: str) -> visum.Part:
        self.hwpart = self.enterContext(real_arm(f"tcp:{self.cable.port}", *options))
        self.client = self.enterContext(visum.Client(self.hwpart.address, name="test", role="admin"))
        self.arm = self.client.part("arm")
        self.client.join()
        self.arm.acquire()
        return self.arm

    def state(self) -> int:
        return int(self.arm.outputs("Part State")[0])

    def angle(self) -> float:
        return self.arm.outputs("Actual Angle")[0]

    def true_angle(self) -> float:
        with visum.Client(self.world.address, name="truth", role="observer") as client:
            return client.part("arm").outputs("Actual Angle")[0]

    def go(self, angle: float) -> None:
        self.arm.inputs("Desired Angle")[0] = angle
        self.arm.write()

    def expect(self, holds, sim_s: float = 10.0) -> None:
        self.assertTrue(wait_until(self.client, self.arm, holds, sim_s), f"state {self.state()}, {self.angle()} rad")

    def test_a_pulled_cable_is_a_fault_and_a_plugged_one_takes_the_arm_back(self) -> None:
        self.serve()
        self.go(0.4)
        self.expect(lambda: self.angle() > 0.03)
        self.cable.pull()
        self.expect(lambda: self.state() == FAULT, 30)
        self.assertTrue(int(self.arm.outputs("Module State")[0]) & COMM_ERROR)
        self.cable.plug()
        self.client.advance_ms(3000)
        self.assertEqual(self.state(), FAULT, "until Reset")
        self.arm.inputs("Reset")[0] = 1
        self.arm.write()
        self.expect(lambda: self.state() == READY)
        stood = self.true_angle()
        self.go(stood - 0.1)
        self.expect(lambda: self.angle() < stood - 0.05)

    def test_it_leaves_nothing_moving_behind(self) -> None:
        self.serve()
        self.go(1.5)
        self.expect(lambda: self.angle() > 0.03)
        self.assertEqual(self.hwpart.end(signal.SIGTERM), 0)
        with visum.Client(self.world.address, name="truth", role="controller") as client:
            arm = client.part("arm")
            client.join()
            self.assertTrue(wait_until(client, arm, lambda: int(arm.outputs("Part State")[0]) == HALTED, 10))

    def test_killed_outright_the_watchdogs_stop_the_arm(self) -> None:
        self.serve("--watchdog")
        self.go(1.5)
        self.expect(lambda: self.angle() > 0.03)
        self.hwpart.end(signal.SIGKILL)
        with visum.Client(self.world.address, name="truth", role="controller") as client:
            arm = client.part("arm")
            client.join()
            self.assertTrue(wait_until(client, arm, lambda: bool(int(arm.outputs("Module State")[0]) & COMM_ERROR), 10))

    def test_time_belongs_to_nobody(self) -> None:
        self.serve()
        for act in (self.client.pause, self.client.reset, self.client.take_snapshot, lambda: self.client.set_speed(2)):
            with self.assertRaisesRegex(visum.Error, "no simulated world"):
                act()

    def refused(self, scene: Path) -> str:
        command = [BIN / "visum-hwpart", scene, "--bus", f"tcp:{self.cable.port}", "--port", "0"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 2, done.stderr)
        return done.stderr

    def test_a_module_of_another_serial_number_is_refused(self) -> None:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        text = ARM.read_text().replace("../", f"{ARM.parent.parent}/")
        text = text.replace("    on_controller_lost: stop", "    modules: {each: {8: {serial_number: 20278}}}")
        (folder / "other.yaml").write_text(text)
        self.assertIn("module 8 has the serial number 40008, not 20278", self.refused(folder / "other.yaml"))


class WithoutABus(unittest.TestCase):
    def refused(self, *arguments: object) -> str:
        command = [BIN / "visum-hwpart", ARM, "--port", "0", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 2)
        return done.stderr

    def test_what_cannot_be_opened_is_named(self) -> None:
        self.assertIn("/nowhere/tty", self.refused("--bus", "serial:/nowhere/tty"))
        self.assertIn("'1234' is no bit rate", self.refused("--bus", "serial:/dev/null,1234"))
        self.assertIn("cannot set up /dev/null", self.refused("--bus", "serial:/dev/null"))
        self.assertIn("serial:DEVICE,BAUD", self.refused("--bus", "rs232:1"))
        self.assertIn("refused", self.refused("--bus", "tcp:1"))
        self.assertIn("there is no part 'amr'; did you mean 'arm'?", self.refused("--bus", "tcp:1", "--part", "amr"))

    def test_a_bus_with_nobody_on_it_is_named(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as nobody:
            text = self.refused("--bus", f"tcp:{nobody.getsockname()[1]}", "--answer-ms", "2")
        self.assertIn("module 1 does not answer; on the bus are: none", text)

    def test_a_kernel_without_can_is_named(self) -> None:
        if "AF_CAN" not in (text := self.refused("--bus", "socketcan:visum0")):
            self.skipTest("this kernel has AF_CAN: " + text)


if __name__ == "__main__":
    unittest.main(verbosity=2)
