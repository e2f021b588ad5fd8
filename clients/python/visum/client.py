"""One connection to a server, and everything that a program can ask of the server."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple

from visum.connection import VERSION, Connection, TlsFiles, pb, refusal_of
from visum.errors import Error, ErrorCode, nearest_hint, unknown_name
from visum.part import ParameterValue, Part, parameter_value
from visum.request_bytes import request_bytes
from visum.token_file import read_token_file
from visum.world import World, WorldView

if TYPE_CHECKING:
    from pathlib import Path

    from visum.kinematics import Chain

_ROLES = {"observer": pb.ROLE_OBSERVER, "controller": pb.ROLE_CONTROLLER, "admin": pb.ROLE_ADMIN}
_SCOPES = {"world": pb.RESET_SCOPE_WORLD, "time": pb.RESET_SCOPE_TIME, "state": pb.RESET_SCOPE_STATE,
           "spawned": pb.RESET_SCOPE_SPAWNED, "all": pb.RESET_SCOPE_ALL}
_MAX_PENDING_WRITES = 32


class ServerInfo(NamedTuple):
    """The server's description of itself, from its welcome."""

    server: str
    scene: str
    clock: str  # realtime, lockstep or free
    tick_ns: int
    simulated: bool  # False if real hardware is behind the parts


class SpawnedModel(NamedTuple):
    """A model that came into the world: its name, and those of its bodies and parts, with its sensors."""

    name: str
    bodies: list[str]
    parts: list[str]


class Client:
    """A session with a server. The constructor connects; leaving a `with` block closes. One thread uses a Client at a time.

    `name` is shown to others as the owner of leases. `role` is observer, controller or admin. `token_file` holds the token
    alone, or lines of "ROLE TOKEN" like the server's own file; only the token for `role` is sent. While nothing listens at
    the address, the constructor keeps trying for `connect_timeout_s`. A server that speaks TLS needs `tls_ca`, `tls_cert` and
    `tls_key`; without them $VISUM_TLS_CA, $VISUM_TLS_CERT and $VISUM_TLS_KEY count.
    """

    def __init__(self, address: str = "127.0.0.1:1500", *, name: str = "python", role: str = "controller",
                 token_file: str | Path | None = None, connect_timeout_s: float = 5.0, tls_ca: str | Path | None = None,
                 tls_cert: str | Path | None = None, tls_key: str | Path | None = None) -> None:
        if role not in _ROLES:
            hint = nearest_hint(role, list(_ROLES)) or f"; there are: {', '.join(_ROLES)}"
            raise Error(ErrorCode.MISUSE, f"there is no role '{role}'{hint}")
        token = read_token_file(token_file, role)
        hello = pb.Hello(min_version=VERSION, max_version=VERSION, client_name=name, role=_ROLES[role], token=token)
        tls = TlsFiles(*(str(file) if file else None for file in (tls_ca, tls_cert, tls_key)))
        if not any(tls):
            tls = TlsFiles.of_environment()
        self.connection = Connection(address, hello, connect_timeout_s, tls)
        welcome = self.connection.welcome
        self.server = ServerInfo(welcome.server, welcome.scene, welcome.clock, welcome.tick_ns, welcome.simulated)
        self.tick = 0  # as of the last join or advance
        self.time_ns = 0
        self.era = 0
        self._parts: list[Part] = []
        self._pending_writes: deque[tuple[int, pb.Write]] = deque()
        self._ahead_ns = 0  # how far the ticks that were asked for are ahead of the sum of the periods
        self._holds_world = False  # the clock is lockstep, and this client has joined
        self._advance: list[int] = []  # the numbers of an advance under way and of the reads behind it
        self._boards: list[tuple[Part, str]] = []  # the blackboards that are among them, at the end
        self._world: World | None = None
        self._world_revision = -1

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Ends the session. Leases that were not released count as lost, and their parts stop."""
        self.connection.close()

    # Parts -----------------------------------------------------------------------------------------------

    def part_names(self) -> list[str]:
        return [part.name for part in self.connection.request(list_parts=pb.ListParts()).parts.parts]

    def part(self, name: str) -> Part:
        names = self.part_names()
        if name not in names:
            raise unknown_name("part", name, names)
        self._parts.append(Part(self, name))
        return self._parts[-1]

    def post_write(self, write: pb.Write) -> None:
        """Sends without waiting. settle_writes() reads the answers."""
        if len(self._pending_writes) >= _MAX_PENDING_WRITES:
            self.settle_writes()
        number = self.connection.send_along(request_bytes(write=write))
        # No tick comes before this member's next advance, which takes the write along.
        if not self._holds_world:
            self.connection.flush()
        self._pending_writes.append((number, write))

    def settle(self) -> Error | None:
        """Waits for the answers to all writes under way, and returns the first refusal."""
        first: Error | None = None
        while self._pending_writes:
            number, write = self._pending_writes.popleft()
            refusal = refusal_of(self.connection.take(number))
            first = first or refusal
            for part in self._parts:
                if refusal and part.name == write.part:
                    part.disown(range(write.first_port, write.first_port + len(write.values)))
        return first

    def settle_writes(self) -> None:
        if refusal := self.settle():
            raise refusal

    # Time ------------------------------------------------------------------------------------------------

    def join(self, timeout_s: float = 0.0) -> None:
        """Joins the clock. Under lockstep the world waits from now on for each advance of this client, at most `timeout_s`
        of wall time (0: the server's default). Under the other clocks advance() only waits for the world."""
        self._set_time(self.connection.request(join=pb.Join(timeout_ns=round(timeout_s * 1e9))).advanced)
        self._ahead_ns = 0
        self._holds_world = self.server.clock == "lockstep"

    def leave(self) -> None:
        # Even if the request fails: the server may have dropped this member already.
        self._holds_world = False
        try:
            self.settle_writes()
        finally:  # also if an earlier write was refused; settle_writes() raises that refusal
            self.connection.request(leave=pb.Leave())

    def advance_ns(self, period_ns: int) -> None:
        """Says "I am done for this period", waits for the first tick at or after the period's end, and brings the samples of
        all parts up to date. Periods do not drift, even if they are no multiple of the tick."""
        self.begin_advance_ns(period_ns)
        self.finish_advance()

    def begin_advance_ns(self, period_ns: int) -> None:
        """The first half of advance_ns(): says so, and does not wait. So worlds of several clients run at the same time, and a
        program can do other things meanwhile. Until finish_advance() no other call of this client or its parts is allowed but
        writes."""
        if period_ns <= 0:
            raise Error(ErrorCode.MISUSE, "a period must be longer than 0 ns")
        if self._advance:
            raise Error(ErrorCode.MISUSE, "an advance is under way: call finish_advance() first")
        missing_ns = period_ns - self._ahead_ns
        ticks = max(0, math.ceil(missing_ns / self.server.tick_ns))
        self._ahead_ns = ticks * self.server.tick_ns - missing_ns
        if ticks > 0:
            # Everything leaves together, so that the server is woken once.
            self._advance = [self.connection.send_along(_advance_request(ticks))]
            self._advance += [self.connection.send_along(part.read_request) for part in self._parts]
            self._boards = [(part, name) for part in self._parts for name in part.next_blackboards()] if self._holds_world else []
            self._advance += [self.connection.send_along(request_bytes(
                read_blackboard=pb.ReadBlackboard(part=part.name, name=name))) for part, name in self._boards]
            self.connection.flush()

    def finish_advance(self) -> None:
        """The second half of advance_ns(): waits, and brings the samples up to date."""
        if not self._advance:
            return
        # All answers are read before anything is raised, so that none is left over for the next period.
        numbers, self._advance = self._advance, []
        refusal = self.settle()
        advanced, *samples = [self.connection.take(number) for number in numbers]
        if stood_still := refusal_of(advanced):
            # The server may have dropped this member: it drops members that come too late.
            self._holds_world = False
            raise refusal or stood_still  # the next advance raises stood_still again
        self._set_time(advanced.advanced)
        # A blackboard that cannot be read is asked for again, and then refused, where the program reads it.
        for (part, name), board in zip(self._boards, samples[len(self._parts):]):
            if board.WhichOneof("body") == "blackboard":
                part.take_blackboard(name, board.blackboard.data)
        for part, sample in zip(self._parts, samples):
            refusal = refusal or refusal_of(sample)
            if sample.WhichOneof("body") == "part_sample":
                part.apply(sample.part_sample)
                if self._holds_world:
                    part.note_brought()
        if refusal:
            raise refusal

    def advance_ms(self, period_ms: float) -> None:
        self.advance_ns(round(period_ms * 1e6))

    def advance_ticks(self, ticks: int) -> None:
        self.advance_ns(ticks * self.server.tick_ns)

    def _set_time(self, now: pb.Advanced) -> None:
        self.tick, self.time_ns, self.era = now.tick, now.sim_time_ns, now.era

    # The world's truth --------------------------------------------------------------------------------

    def status(self) -> pb.ServerStatus:
        """The message ServerStatus: tick, clock, pace, lateness, the clients that the lockstep waits for, and more."""
        return self.connection.request(status=pb.Status()).status

    def world(self) -> World:
        """The names of bodies and joints, and the whole description."""
        description = self.connection.request(describe_world=pb.DescribeWorld()).world_description
        self._world, self._world_revision = World(description), description.revision
        return self._world

    def read_world(self) -> WorldView:
        """The world at the newest tick."""
        sample = self.connection.request(read_world=pb.ReadWorld()).world_sample
        if self._world is None or self._world_revision != sample.revision:
            self.world()
        assert self._world is not None
        return WorldView(self._world, sample)

    def chain(self, body: str) -> Chain:
        """The chain of driven joints that carries a body of the world, for forward and inverse kinematics."""
        from visum.kinematics import chain_of  # here, because few controllers need it

        return chain_of(self.world().description, self.read_world().sample, body)

    def subscribe_events(self, level: str = "info") -> list[pb.Event]:
        """Returns what has happened before, and lets events() also bring the server's log, leases, faults, and what clients
        announce, from now on. `level`: the least, of debug, info, warning and error."""
        request = pb.SubscribeEvents(level=_level(level))
        return list(self.connection.request(subscribe_events=request).events.events)

    def unsubscribe_events(self) -> None:
        self.connection.request(unsubscribe_events=pb.UnsubscribeEvents())

    def announce(self, text: str, *, kind: str = "line", level: str = "info") -> None:
        """Tells those who follow events something. `kind`: line, or check for the result of one. Needs the role controller."""
        self.connection.request(announce=pb.Announce(text=text, kind=kind, level=_level(level)))

    def events(self) -> list[pb.Event]:
        """The events since the last call: lease_lost, lockstep_timeout, era, frozen, ..."""
        self.connection.poll()
        events = list(self.connection.events)
        self.connection.events.clear()
        return events

    # Role admin ------------------------------------------------------------------------------------------

    def pause(self) -> None:
        self.connection.request(pause=pb.Pause())

    def resume(self) -> None:
        self.connection.request(resume=pb.Resume())

    def step(self, ticks: int = 1) -> None:
        """Runs that many ticks while the world is paused."""
        self.connection.request(step=pb.Step(ticks=ticks))

    def set_speed(self, factor: float) -> None:
        """Sets how many simulated seconds pass in a second of wall time, under the realtime clock."""
        self.connection.request(set_speed=pb.SetSpeed(factor=factor))

    def reset(self, scope: str = "world") -> None:
        """Returns to the scene's beginning. `scope`: world (time and state), time, state, spawned (what came since the scene was
        loaded goes, what went is back) or all. All but spawned begin a new era."""
        if scope not in _SCOPES:
            hint = nearest_hint(scope, list(_SCOPES)) or f"; there are: {', '.join(_SCOPES)}"
            raise Error(ErrorCode.MISUSE, f"there is no scope '{scope}'{hint}")
        self.connection.request(reset=pb.Reset(scope=_SCOPES[scope]))

    def take_snapshot(self, name: str = "") -> int:
        """Returns the snapshot's number. With a name, which begins with a letter, it is also kept on the server's disk."""
        return self.connection.request(take_snapshot=pb.TakeSnapshot(name=name)).snapshot.snapshot

    def restore_snapshot(self, snapshot: int | str) -> None:
        """Goes back to a snapshot, by its number, or by its name on the server's disk."""
        which = {"name": snapshot} if isinstance(snapshot, str) else {"snapshot": snapshot}
        self.connection.request(restore_snapshot=pb.RestoreSnapshot(**which))

    def start_recording(self, name: str) -> None:
        """Records the running world from now on, into a file of the server. The name begins with a letter."""
        self.connection.request(start_recording=pb.StartRecording(name=name))

    def stop_recording(self) -> None:
        self.connection.request(stop_recording=pb.StopRecording())

    def run_scenario(self, name: str, timeout_s: float = 0.0) -> None:
        """Lets the server run a scenario of its installation beside its world, in a world of its own, for at most so many
        seconds of wall time (0: an hour). Its course comes as events; scenario() says how it ended."""
        self.connection.request(run_scenario=pb.RunScenario(name=name, timeout_ns=round(timeout_s * 1e9)))

    def stop_scenario(self) -> None:
        self.connection.request(stop_scenario=pb.StopScenario())

    def scenario(self) -> pb.ScenarioState:
        """The scenario that runs, or ran last. Any role."""
        return self.connection.request(read_scenario=pb.ReadScenario()).scenario

    def modules(self, part: str = "") -> pb.ModuleList:
        """The modules that controllers have announced, with their newest values; of one part of a controller, or of all."""
        return self.connection.request(list_modules=pb.ListModules(part=part)).modules

    def hold_sensor_input(self, part: str, module: str, port: str, value: float | None) -> None:
        """Makes a sensor input of a running module hold a value against its edge, for a test. None: the edge counts again."""
        self.connection.request(override_module_port=pb.OverrideModulePort(
            part=part, path=module, port=port, value=value or 0.0, release=value is None))

    def set_module_parameter(self, part: str, module: str, name: str, value: ParameterValue) -> None:
        """Changes a parameter of a running module. It is in force once `modules()` shows it."""
        self.connection.request(set_module_parameter=pb.SetModuleParameter(
            part=part, path=module, name=name, value=parameter_value(name, value)))

    def push_body(self, body: str, force_n: Sequence[float], duration_s: float, *, torque_nm: Sequence[float] = (),
                  point_m: Sequence[float] = ()) -> None:
        """Pushes a body for `duration_s` of simulated time. Vectors are in the world frame. Without a point the force acts at
        the centre of mass."""
        self.connection.request(push_body=pb.PushBody(body=body, force_n=force_n, torque_nm=torque_nm,
                                                      point_m=point_m, duration_ns=round(duration_s * 1e9)))

    def set_body(self, body: str, position_m: Sequence[float] | None = None, quaternion: Sequence[float] | None = None, *,
                 velocity: Sequence[float] = (), turn_rate: Sequence[float] = (), keeps_moving: bool = False) -> None:
        """Puts a free or kinematic body elsewhere: its link frame, in the world frame. Without a position it stays where it is;
        without a quaternion (w, x, y, z) it keeps its direction. m/s and rad/s, world frame; default: at rest. A kinematic body
        keeps the velocity until it is set again, or this session ends, unless `keeps_moving`."""
        pose: list[float] = []
        if position_m is not None or quaternion is not None:
            now = self.read_world().body(body)
            pose = [*(now.position if position_m is None else position_m),
                    *(now.quaternion if quaternion is None else quaternion)]
        motion = [*(velocity or (0.0, 0.0, 0.0)), *(turn_rate or (0.0, 0.0, 0.0))]
        self.connection.request(set_body=pb.SetBody(body=body, pose=pose, velocity=motion, keeps_moving=keeps_moving))

    def set_joints(self, model: str, positions: Mapping[str, float], velocities: Mapping[str, float] | None = None, *,
                   keeps_moving: bool = False) -> None:
        """Puts joints of a model elsewhere, rad or m, and those that follow them. Drives stand there until they get a new
        command. Joints of a kinematic model keep their velocities until they are set again, or this session ends, unless
        `keeps_moving`."""
        rates = velocities or {}
        if unknown := [name for name in rates if name not in positions]:
            raise Error(ErrorCode.MISUSE, f"joint '{unknown[0]}' has a velocity and no position")
        joints = [pb.JointTarget(name=name, position=position, velocity=rates.get(name, 0.0))
                  for name, position in positions.items()]
        self.connection.request(set_joints=pb.SetJoints(model=model, joints=joints, keeps_moving=keeps_moving))

    def pull_body(self, body: str, target_m: Sequence[float], max_force_n: float, *, point_m: Sequence[float] = (),
                  duration_s: float = 0.0) -> None:
        """Pulls a point of a body (in its link frame; default: the centre of mass) to a target in the world frame, with a spring
        and damper that the server computes. Another call for the same body moves the target. The pull ends after `duration_s` of
        simulated time (0: never), with release_body(), or with this session."""
        self.connection.request(pull_body=pb.PullBody(body=body, point_m=point_m, target_m=target_m, max_force_n=max_force_n,
                                                      duration_ns=round(duration_s * 1e9)))

    def release_body(self, body: str) -> None:
        self.connection.request(release_body=pb.ReleaseBody(body=body))

    def add_body(self, yaml: str) -> None:
        """Adds a body, given as one entry of a scene's `bodies:`."""
        self.connection.request(add_body=pb.AddBody(yaml=yaml))

    def remove_body(self, name: str) -> None:
        self.connection.request(remove_body=pb.RemoveBody(body=name))

    def models(self) -> list[str]:
        """The models of the server that spawn() takes by name."""
        return list(self.connection.request(list_models=pb.ListModels()).models.files)

    def spawned_models(self) -> list[str]:
        return list(self.connection.request(list_models=pb.ListModels()).models.spawned)

    def spawn(self, file: str, name: str = "", *, position_m: Sequence[float] = (0.0, 0.0, 0.0),
              quaternion: Sequence[float] = (1.0, 0.0, 0.0, 0.0), unique: bool = False,
              files: Mapping[str, bytes] | None = None) -> SpawnedModel:
        """Brings a model with its parts, drives and sensors into the world. `file` is one of models(); or, with `files`, one of
        these: relative paths and contents, in place of the server's files (model_files() gathers them). `unique` puts a number
        behind a name that is taken, instead of an error. The pose is that of the model's origin, in the world frame."""
        sent = [pb.ModelFile(path=path, content=content) for path, content in (files or {}).items()]
        reply = self.connection.request(spawn_model=pb.SpawnModel(
            file=file, name=name, pose=[*position_m, *quaternion], make_unique=unique, files=sent)).model_spawned
        return SpawnedModel(reply.name, list(reply.bodies), list(reply.parts))

    def remove_model(self, name: str) -> None:
        """Takes a model that was spawned out of the world, with its parts and sensors."""
        self.connection.request(remove_model=pb.RemoveModel(name=name))

    def scenes(self) -> list[str]:
        """The scenes of the server that load_scene() takes."""
        return list(self.connection.request(list_scenes=pb.ListScenes()).scenes.scenes)

    def scenarios(self) -> list[str]:
        """The scenarios of the server."""
        return list(self.connection.request(list_scenes=pb.ListScenes()).scenes.scenarios)

    def load_scene(self, scene: str) -> None:
        """Puts another scene in the world's place, and begins a new era at time 0. Parts and leases of the scene before are gone:
        ask for the new parts."""
        self.connection.request(load_scene=pb.LoadScene(scene=scene))

    def shutdown(self) -> None:
        self.connection.request(shutdown=pb.Shutdown())


@lru_cache(maxsize=16)
def _advance_request(ticks: int) -> bytes:
    return request_bytes(advance=pb.Advance(ticks=ticks))


def _level(name: str) -> int:
    levels = {"debug": pb.EVENT_LEVEL_DEBUG, "info": pb.EVENT_LEVEL_INFO, "warning": pb.EVENT_LEVEL_WARNING,
              "error": pb.EVENT_LEVEL_ERROR}
    if name not in levels:
        hint = nearest_hint(name, list(levels)) or f"; there are: {', '.join(levels)}"
        raise Error(ErrorCode.MISUSE, f"there is no level '{name}'{hint}")
    return levels[name]
