"""A part as an environment with Gymnasium's interface, over lockstep: learning programs and searches step it.

    def reward(now: Environment) -> float:
        return -abs(now.value("Actual Angle 1") - 0.5)

    with Environment("two_link.yaml", "robot", actions=["Desired Angle"], observations=["Actual Angle", "Actual Speed"],
                     reward=reward, max_steps=200) as environment:
        observation, info = environment.reset(seed=1)
        observation, reward, terminated, truncated, info = environment.step([0.5, 0.0])

Each environment has a daemon of its own. Equal seeds and actions give equal bits. Where the package gymnasium is installed, an
Environment is a gymnasium.Env with its spaces; without it, it has the same methods, and Box below. Needs numpy.
Source: https://gymnasium.farama.org/api/env/ (interface of version 1.0).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy

from visum.errors import Error, ErrorCode
from visum.launching import LaunchedClient, launch
from visum.part import Part
from visum.ports import Port, find_ports
from visum.scene import Scene

Array = numpy.ndarray[Any, numpy.dtype[numpy.float64]]
Info = dict[str, Any]


class _Box:
    """Vectors with a least and a greatest value for each element; stands for gymnasium.spaces.Box where that is not installed."""

    def __init__(self, low: Array, high: Array, dtype: type = numpy.float64) -> None:
        self.low, self.high, self.shape, self.dtype = low, high, low.shape, numpy.dtype(dtype)
        self._random = numpy.random.default_rng()

    def seed(self, seed: int | None = None) -> None:
        self._random = numpy.random.default_rng(seed)

    def sample(self) -> Array:
        """A random vector of the space: uniform where both bounds are finite, else standard normal within the bounds."""
        bounded = numpy.isfinite(self.low) & numpy.isfinite(self.high)
        normal = numpy.clip(self._random.standard_normal(self.shape), self.low, self.high)
        low, high = numpy.where(bounded, self.low, 0.0), numpy.where(bounded, self.high, 0.0)
        return numpy.where(bounded, self._random.uniform(low, high), normal)

    def contains(self, x: Any) -> bool:
        vector = numpy.asarray(x, dtype=float)
        return vector.shape == self.shape and bool(numpy.all((vector >= self.low) & (vector <= self.high)))

    __contains__ = contains

    def __repr__(self) -> str:
        return f"Box({self.low}, {self.high})"


class _Env:
    """Stands for gymnasium.Env where that is not installed."""

    def reset(self, *, seed: int | None = None, options: Info | None = None) -> Any:
        if seed is not None or not hasattr(self, "np_random"):
            self.np_random = numpy.random.default_rng(seed)

    @property
    def unwrapped(self) -> Any:
        return self

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None: ...


try:
    from gymnasium import Env as _Base
    from gymnasium.spaces import Box
except ImportError:
    _Base, Box = _Env, _Box


class Environment(_Base):  # type: ignore[misc, valid-type]
    """One part of one world. `actions` and `observations` name ports, or groups of ports, of the part, in the order of the vectors'
    elements. A step writes the action, lets `step_ms` of simulated time pass and reads the observation.

    `reward` and `terminated` are called after each step with this environment. An episode is truncated after `max_steps`.
    Further words in `options` go to visumd, as in launch().

    reset(seed=N) starts the daemon anew with that seed for the world's random numbers, and seeds `np_random`. reset() without a seed
    takes the running world back to its start. `info` has "tick" and "sim_time_s".
    """

    metadata: Info = {"render_modes": []}
    render_mode = None
    spec = None

    def __init__(self, scene: str | Path | Scene, part: str, *, actions: Sequence[str], observations: Sequence[str],
                 reward: Callable[[Environment], float], terminated: Callable[[Environment], bool] | None = None,
                 step_ms: float = 10.0, max_steps: int | None = None, options: Sequence[str] = (),
                 program: str | Path | None = None) -> None:
        self._scene, self._part_name, self._words, self._program = scene, part, list(options), program
        self._actions, self._observations = list(actions), list(observations)
        self._reward, self._terminated = reward, terminated
        self._step_ns, self._max_steps = round(step_ms * 1e6), max_steps
        self.steps = 0  # of this episode
        self._ended = True  # step() must wait for reset()
        self._started = False
        self.client: LaunchedClient | None = None
        self.part: Part
        self.action: Array
        self.observation: Array
        self._start(None)

    def _start(self, seed: int | None) -> None:
        self.close()
        words = [*self._words, *(["--seed", str(seed)] if seed is not None else [])]
        self.client = launch(self._scene, *words, clock="lockstep", name="environment", role="admin", program=self._program)
        try:
            self._bind(self.client)
        except BaseException:
            self.close()
            raise
        self._started = True

    def _bind(self, client: LaunchedClient) -> None:
        self.part = client.part(self._part_name)
        self._inputs = self._ports_of("controller input", self.part.input_ports, self._actions)
        self._outputs = self._ports_of("sensor output", self.part.output_ports, self._observations)
        self.action_space, self.observation_space = _space(self._inputs), _space(self._outputs)
        self.part.acquire()
        client.join()

    def _ports_of(self, vector: str, ports: list[Port], names: list[str]) -> list[Port]:
        return [port for name in names for port in find_ports(self._part_name, vector, ports, name)]

    def value(self, port: str) -> float:
        """The newest value of one sensor output, whether it is observed or not."""
        return self.part.outputs(port)[0]

    def reset(self, *, seed: int | None = None, options: Info | None = None) -> tuple[Array, Info]:
        super().reset(seed=seed, options=options)
        if seed is not None or self.client is None:
            self._start(seed)
        elif not self._started:
            self.client.reset()
            self.part.read()
        self._started = False
        self.steps, self._ended = 0, False
        self.action = numpy.array([self.part.input_values[port.index] for port in self._inputs])
        return self._observe()

    def step(self, action: Sequence[float] | Array) -> tuple[Array, float, bool, bool, Info]:
        self.begin_step(action)
        return self.finish_step()

    def begin_step(self, action: Sequence[float] | Array) -> None:
        """The first half of step(), which does not wait: so several worlds run at the same time."""
        self.action = self.checked(action)
        assert self.client
        for port, value in zip(self._inputs, self.action.tolist()):
            self.part.stage(port.index, value)
        self.part.write()
        self.client.begin_advance_ns(self._step_ns)

    def checked(self, action: Sequence[float] | Array) -> Array:
        """The action as a vector. Raises where step() would refuse it."""
        if self._ended or self.client is None:
            raise Error(ErrorCode.MISUSE, "the episode has ended: call reset() first")
        vector = numpy.asarray(action, dtype=float)
        if vector.shape != (len(self._inputs),):
            raise Error(ErrorCode.MISUSE, f"an action has {len(self._inputs)} values, and not the shape {vector.shape}")
        if not self.action_space.contains(vector):
            raise Error(ErrorCode.BAD_VALUE, f"the action {vector.tolist()} is not in {self.action_space}")
        return vector

    def finish_step(self) -> tuple[Array, float, bool, bool, Info]:
        """The second half of step()."""
        assert self.client
        self.client.finish_advance()
        self.steps += 1
        observation, info = self._observe()
        terminated = self._terminated is not None and bool(self._terminated(self))
        truncated = self._max_steps is not None and self.steps >= self._max_steps
        self._ended = terminated or truncated
        return observation, float(self._reward(self)), terminated, truncated, info

    def _observe(self) -> tuple[Array, Info]:
        assert self.client
        values = self.part.output_values
        self.observation = numpy.array([values[port.index] for port in self._outputs])
        return self.observation, {"tick": self.part.sample_tick, "sim_time_s": self.part.sample_time_ns * 1e-9}

    def close(self) -> None:
        if self.client is not None:
            self.client.close()
        self.client, self._ended = None, True


def _space(ports: list[Port]) -> Any:
    return Box(numpy.array([port.minimum for port in ports]), numpy.array([port.maximum for port in ports]), dtype=numpy.float64)


class VectorEnvironment:
    """Several equal environments side by side, with the methods of gymnasium.vector.VectorEnv. Their daemons run at the same time.

    Vectors have one row for each environment. An environment whose episode has ended is reset by the next step(), which ignores its
    action and returns its first observation with a reward of 0 ("next-step autoreset").
    """

    def __init__(self, make: Callable[[], Environment], count: int) -> None:
        if count < 1:
            raise Error(ErrorCode.MISUSE, f"there must be at least one environment, and not {count}")
        self.environments: list[Environment] = []
        try:
            for _ in range(count):
                self.environments.append(make())
        except BaseException:
            self.close()
            raise
        self.num_envs = count
        self.single_action_space = self.environments[0].action_space
        self.single_observation_space = self.environments[0].observation_space
        self._done = [False] * count

    def reset(self, *, seed: int | Sequence[int] | None = None, options: Info | None = None) -> tuple[Array, Info]:
        """A number seeds the environments with seed, seed + 1, ..."""
        seeds = [None if seed is None else seed + i if isinstance(seed, int) else seed[i] for i in range(self.num_envs)]
        results = [environment.reset(seed=own, options=options) for environment, own in zip(self.environments, seeds)]
        self._done = [False] * self.num_envs
        return numpy.stack([observation for observation, _ in results]), _merged([info for _, info in results])

    def step(self, actions: Sequence[Sequence[float]] | Array) -> tuple[Array, Array, Array, Array, Info]:
        if len(actions) != self.num_envs:
            raise Error(ErrorCode.MISUSE, f"there are {self.num_envs} environments, and {len(actions)} actions")
        waiting = [(environment, environment.checked(action))  # all of them, before any world moves
                   for environment, action, done in zip(self.environments, actions, self._done) if not done]
        for environment, action in waiting:
            environment.begin_step(action)
        results = []
        for environment, done in zip(self.environments, self._done):
            if done:
                observation, info = environment.reset()
                results.append((observation, 0.0, False, False, info))
            else:
                results.append(environment.finish_step())
        observations, rewards, terminated, truncated, infos = zip(*results)
        self._done = [a or b for a, b in zip(terminated, truncated)]
        return numpy.stack(observations), numpy.array(rewards), numpy.array(terminated), numpy.array(truncated), _merged(infos)

    def close(self) -> None:
        for environment in self.environments:
            environment.close()

    def __enter__(self) -> VectorEnvironment:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _merged(infos: Sequence[Info]) -> Info:
    return {key: numpy.array([info[key] for info in infos]) for key in infos[0]}
