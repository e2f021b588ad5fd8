"""Environments with Gymnasium's interface: equal seeds and actions give equal bits, alone and side by side."""
import sys
import unittest

import numpy

from programs import BIN, SOURCE

sys.path.insert(0, str(BIN.parent / "python"))
from visum import Error, ErrorCode  # noqa: E402
from visum.environment import Environment, VectorEnvironment  # noqa: E402

TWO_LINK = SOURCE / "models" / "scenes" / "two_link.yaml"


def make(**more):
    return Environment(TWO_LINK, "robot", actions=["Desired Angle"], observations=["Actual Angle", "Actual Speed"],
                       reward=lambda now: -abs(now.value("Actual Angle 1") - 0.5), **{"max_steps": 20, **more})


def episode(environment, **seed):
    """All observations and rewards of an episode."""
    observation, _ = environment.reset(**seed)
    rows, ended = [observation], False
    while not ended:
        observation, reward, terminated, truncated, info = environment.step([0.5, 0.1 * environment.steps / 20])
        rows.append(numpy.append(observation, [reward, info["sim_time_s"]]))
        ended = terminated or truncated
    return numpy.concatenate(rows)


class Environments(unittest.TestCase):
    def test_episodes_repeat_to_the_bit(self):
        with make() as one, make() as other:
            first = episode(one, seed=7)
            self.assertEqual(first.size, 4 + 20 * 6)
            numpy.testing.assert_array_equal(episode(one), first)
            numpy.testing.assert_array_equal(episode(one, seed=7), first)
            numpy.testing.assert_array_equal(episode(other, seed=7), first)
            self.assertGreater(first[-6], first[0])  # it has moved towards 0.5

    def test_spaces_are_the_ports_ranges(self):
        with make() as environment:
            self.assertEqual(environment.action_space.shape, (2,))
            self.assertEqual(environment.observation_space.shape, (4,))
            self.assertEqual(environment.observation_space.low[0], -7.77)
            self.assertTrue(environment.action_space.contains(environment.action_space.sample()))
            observation, info = environment.reset(seed=1)
            self.assertTrue(environment.observation_space.contains(observation))
            self.assertEqual(info["sim_time_s"], 0)

    def test_an_episode_ends_where_it_is_said_to_and_must_be_reset(self):
        with make(terminated=lambda now: now.steps == 3) as environment:
            with self.assertRaises(Error):
                environment.step([0, 0])
            environment.reset()
            ends = [environment.step([0.5, 0])[2:4] for _ in range(3)]
            self.assertEqual(ends, [(False, False), (False, False), (True, False)])
            with self.assertRaises(Error) as caught:
                environment.step([0, 0])
            self.assertIn("reset()", str(caught.exception))

    def test_a_bad_action_is_refused_and_nothing_moves(self):
        with make() as environment:
            environment.reset()
            for bad, code in (([0.1], ErrorCode.MISUSE), ([float("nan"), 0], ErrorCode.BAD_VALUE), ([1e9, 0], ErrorCode.BAD_VALUE)):
                with self.subTest(bad), self.assertRaises(Error) as caught:
                    environment.step(bad)
                self.assertEqual(caught.exception.code, code)
            self.assertEqual(environment.step([0.5, 0])[4]["sim_time_s"], 0.01)

    def test_an_unknown_port_is_named(self):
        with self.assertRaises(Error) as caught:
            Environment(TWO_LINK, "robot", actions=["Desired Angel"], observations=["Actual Angle"], reward=lambda now: 0)
        self.assertIn("did you mean 'Desired Angle", str(caught.exception))

    def test_side_by_side_they_have_the_bits_that_each_has_alone(self):
        with make(max_steps=5) as alone:
            alone.reset(seed=4)
            expected = [alone.step([0.5, 0.1])[0] for _ in range(5)]
            start, _ = alone.reset()
        with VectorEnvironment(lambda: make(max_steps=5), 3) as several:
            several.reset(seed=3)  # 3, 4 and 5
            for row in expected:
                observations, rewards, _, truncated, infos = several.step([[0.5, 0.1]] * 3)
                numpy.testing.assert_array_equal(observations[1], row)
            self.assertEqual(truncated.tolist(), [True] * 3)
            with self.assertRaises(Error):
                several.step([[0.5, 0.1]] * 2)
            # An action for an episode that has ended is not looked at.
            observations, rewards, _, truncated, infos = several.step([[9e9, 0]] * 3)
            numpy.testing.assert_array_equal(observations[1], start)
            self.assertEqual((rewards.tolist(), truncated.tolist(), infos["sim_time_s"].tolist()), ([0] * 3, [False] * 3, [0] * 3))

    def test_a_bad_action_of_one_moves_none(self):
        with VectorEnvironment(make, 2) as several:
            several.reset()
            with self.assertRaises(Error):
                several.step([[0.5, 0], [float("inf"), 0]])
            self.assertEqual(several.step([[0.5, 0]] * 2)[4]["sim_time_s"].tolist(), [0.01] * 2)


if __name__ == "__main__":
    unittest.main()
