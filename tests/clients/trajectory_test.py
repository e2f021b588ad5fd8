"""The arm follows a trajectory from its blackboard: written whole, by offset, and under a lock, by the real programs."""
import struct
import sys
import unittest

from programs import BIN, Daemon

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402

BOARD = "Trajectory"


class Trajectory(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(Daemon("--clock", "lockstep"))
        self.client = self.enterContext(visum.Client(self.daemon.connect, name="test"))
        self.arm = self.client.part("arm")
        self.client.join()
        self.arm.acquire()
        self.start = [*self.arm.outputs("Actual Angle").values(), *self.arm.outputs("Actual Finger Position").values()]

    def point(self, time_s, angle):
        return time_s, [angle, *self.start[1:]]

    def bytes_of(self, *points):
        return b"".join(struct.pack(f"<{1 + len(row)}d", time, *row) for time, row in points)

    def angle_after(self, seconds):
        self.client.advance_ms(1000 * seconds)
        return self.arm.outputs("Actual Angle")[0]

    def test_it_is_followed_in_time(self):
        self.arm.follow_trajectory([self.point(1.5, 0.4), self.point(3, 0.7), self.point(5, 0.2)])
        self.assertAlmostEqual(self.angle_after(1.5), 0.4, delta=0.02)
        self.assertAlmostEqual(self.angle_after(1.5), 0.7, delta=0.02)
        self.assertAlmostEqual(self.angle_after(2.2), 0.2, delta=0.002)
        self.assertEqual(len(self.arm.read_blackboard(BOARD)), 3 * 80)

    def test_rows_can_be_added_by_their_offset(self):
        self.arm.write_blackboard(BOARD, self.bytes_of(self.point(1.5, 0.3)))
        self.arm.write_blackboard(BOARD, self.bytes_of(self.point(3, 0.5)), 80)
        self.assertAlmostEqual(self.angle_after(3.2), 0.5, delta=0.002)
        with self.assertRaisesRegex(visum.Error, "begins beyond the content"):
            self.arm.write_blackboard(BOARD, self.bytes_of(self.point(3, 0.6)), 999)

    def test_what_is_written_under_a_lock_acts_at_once_or_not_at_all(self):
        with self.arm.locked_blackboard(BOARD, 1.0):
            self.arm.write_blackboard(BOARD, self.bytes_of(self.point(1.5, 0.3))[:50])  # no whole row
            self.assertAlmostEqual(self.angle_after(0.5), self.start[0], delta=1e-3)
            self.arm.write_blackboard(BOARD, self.bytes_of(self.point(1.5, 0.3), self.point(3, 0.5))[50:], 50)
        self.assertAlmostEqual(self.angle_after(3.2), 0.5, delta=0.002)
        with self.assertRaisesRegex(visum.Error, "row 1: Desired Angle 1 must be within"):
            with self.arm.locked_blackboard(BOARD, 1.0):
                self.arm.write_blackboard(BOARD, self.bytes_of(self.point(1, 99.0)))
        with self.assertRaises(ZeroDivisionError):
            with self.arm.locked_blackboard(BOARD, 1.0):
                self.arm.write_blackboard(BOARD, self.bytes_of(self.point(2, 0.0)))
                raise ZeroDivisionError
        self.assertAlmostEqual(self.angle_after(1.2), 0.5, delta=0.002)

    def test_a_lock_ends_with_its_time_out(self):
        with self.assertRaisesRegex(visum.Error, "its time-out passed"):
            with self.arm.locked_blackboard(BOARD, 0.1):
                self.arm.write_blackboard(BOARD, self.bytes_of(self.point(2, 0.5)))
                self.client.advance_ms(200)
        self.assertAlmostEqual(self.angle_after(1.2), self.start[0], delta=1e-3)
        request = self.client.connection.request
        pb = visum.connection.pb
        for timeout_ns in (0, -1, 60_000_000_001):
            with self.assertRaisesRegex(visum.Error, "timeout_ns must be within"):
                request(lock_blackboard=pb.LockBlackboard(part="arm", name=BOARD, timeout_ns=timeout_ns))
        with self.assertRaisesRegex(visum.Error, "has not locked"):
            request(unlock_blackboard=pb.UnlockBlackboard(part="arm", name=BOARD))

    def test_it_needs_the_lease(self):
        with visum.Client(self.daemon.connect, name="other") as other:
            for call in (lambda: other.part("arm").write_blackboard(BOARD, b""),
                         lambda: other.part("arm").locked_blackboard(BOARD, 1.0).__enter__()):
                with self.assertRaisesRegex(visum.Error, "leased"):
                    call()


if __name__ == "__main__":
    unittest.main()
