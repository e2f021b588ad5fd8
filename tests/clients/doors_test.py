"""The programs where others do not behave: nobody reads the log, names forge lines, a terminal closes, a token is a pipe."""
import contextlib
import fcntl
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from certificates import WithCertificates
from programs import ARM, BIN, DEADLINE_S, Daemon, visum

sys.path.insert(0, str(BIN.parent / "python"))
from visum import Client, Error, visum_pb2 as pb  # noqa: E402

# A newline, ESC, NEL, CSI, a separator of lines, and a mark that turns round what follows.
EVIL = "arm\n\033[2J\u0085\u009b2J\u2028\u202e"
SAFE = r"arm\x0a\x1b[2J\u0085\u009b2J\u2028\u202e"


class Logged(Daemon):
    """A Daemon whose log goes to `stderr`. It is killed at the deadline, so that a client which waits
    for it fails instead of hanging."""

    def __init__(self, *options, stderr, before=None, verbosity=1):
        super().__init__("--http", "off", *options)
        self.command[self.command.index("-v") + 1] = str(verbosity)
        self.stderr, self.before = stderr, before

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=self.stderr, text=True,
                                        preexec_fn=self.before)
        self.killer = threading.Timer(DEADLINE_S, self.process.kill)
        self.killer.daemon = True
        self.killer.start()
        return self.wait_until_ready()

    def __exit__(self, *_):
        super().__exit__()
        self.killer.cancel()


def refused_reset(client):
    """True if the daemon answers that only an admin may reset."""
    try:
        client.connection.request(reset=pb.Reset())
    except Error as error:
        return "this needs the role admin" in str(error)
    return False


@contextlib.contextmanager
def full_pipe():
    """The writing end of a pipe that nobody reads and that takes nothing more."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, b"x" * 4096)
    os.set_blocking(writer, True)  # the daemon shares this setting
    try:
        yield reader, writer
    finally:
        os.close(reader)
        os.close(writer)


class Log(unittest.TestCase):
    def attack(self, *options):
        with full_pipe() as (reader, writer), Logged(*options, stderr=writer) as daemon:
            with Client(daemon.connect, name="attacker", role="observer") as attacker:
                for _ in range(1000):
                    self.assertTrue(refused_reset(attacker))
                with Client(daemon.connect, name="boss", role="admin") as boss:
                    self.assertIn("arm", boss.part_names())
                daemon.process.send_signal(signal.SIGTERM)
                self.assertEqual(daemon.process.wait(timeout=DEADLINE_S), 0)

    def test_a_log_that_nobody_reads_holds_nobody_up_in_real_time(self):
        self.attack("-r")

    def test_a_log_that_nobody_reads_holds_nobody_up_in_lockstep(self):
        self.attack("--clock", "lockstep")

    def test_one_session_causes_few_lines_and_each_request_is_answered(self):
        with tempfile.TemporaryFile("w+") as log, Logged(stderr=log) as daemon:
            began = time.monotonic()
            with Client(daemon.connect, name="attacker", role="observer") as attacker:
                for _ in range(3000):
                    self.assertTrue(refused_reset(attacker))
            took_s = time.monotonic() - began
            daemon.process.send_signal(signal.SIGTERM)
            daemon.process.wait(timeout=DEADLINE_S)
            log.seek(0)
            text = log.read()
        written = len(re.findall(r"^visumd: warning: 'attacker' at [\d.:]+ is refused: this needs the role admin", text, re.M))
        left_out = sum(map(int, re.findall(r"'attacker' at [\d.:]+: (\d+) further lines were left out$", text, re.M)))
        self.assertEqual(written + left_out, 3000, text[:2000])
        self.assertGreaterEqual(written, 9)
        self.assertLessEqual(written, 20 * (took_s + 1))

    def test_errors_at_the_start_are_written_whole_before_the_end(self):
        for program, words, code in (("visumd", [ARM.parent / "missing.yaml"], 3), ("visumd", [ARM, "--listen", "0.0.0.0", "--http", "off"], 2),
                                     ("visum-hwpart", [ARM, "--part", "arm", "--bus", "serial:/nowhere,9600"], 2),
                                     ("visum-mirror", ["--primary", "127.0.0.1:1", "--shadow", "127.0.0.1:1"], 2)):
            done = subprocess.run([BIN / program, *map(str, words)], capture_output=True, text=True, timeout=DEADLINE_S)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertRegex(done.stderr, rf"\A{program}: error: [^\n]+\n\Z")

    def test_errors_at_the_start_do_not_wait_for_a_reader(self):
        with full_pipe() as (reader, writer):
            done = subprocess.run([BIN / "visumd", "missing.yaml"], stdout=subprocess.PIPE, stderr=writer, timeout=DEADLINE_S)
        self.assertEqual(done.returncode, 3)


class Signals(unittest.TestCase):
    def test_a_closed_terminal_ends_the_daemon_in_good_order(self):
        for clock in ("realtime", "lockstep"):
            with tempfile.TemporaryFile("w+") as log, Logged("--clock", clock, stderr=log, verbosity=2) as daemon:
                daemon.process.send_signal(signal.SIGHUP)
                self.assertEqual(daemon.process.wait(timeout=DEADLINE_S), 0)
                log.seek(0)
                self.assertIn("visumd: info: ended at tick", log.read())

    def test_nohup_keeps_it(self):
        with tempfile.TemporaryFile("w+") as log, Logged(
                stderr=log, before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)) as daemon:
            daemon.process.send_signal(signal.SIGHUP)
            daemon.json("status")


class TokenFile(unittest.TestCase):
    def test_a_pipe_as_token_file_is_refused_at_once(self):
        with tempfile.TemporaryDirectory() as folder:
            pipe = pathlib.Path(folder, "tokens")
            os.mkfifo(pipe, 0o600)
            done = subprocess.run([BIN / "visumd", ARM, "--http", "off", "--token-file", pipe], capture_output=True, text=True,
                                  timeout=DEADLINE_S)
        self.assertEqual((done.returncode, done.stderr), (3, f"visumd: error: {pipe}: is not a regular file\n"))


class Welcome(unittest.TestCase):
    def test_names_program_and_version(self):
        version = subprocess.run([BIN / "visumd", "--version"], capture_output=True, text=True).stdout.strip()
        self.assertRegex(version, r"^visumd \d+\.\d+\.\d+$")
        with Daemon() as arm:
            self.assertEqual(arm.json("status")["server"], version)
            self.assertRegex(arm.visum("status").stdout, rf"(?m)^server +{re.escape(version)}  VIRTUAL$")
            with Client(arm.connect) as client:
                self.assertEqual(client.server.server, version)


class Names(unittest.TestCase):
    def test_a_client_is_refused_by_a_name_that_could_forge_a_line(self):
        with Daemon() as daemon:
            for mark in EVIL[3:]:
                if mark.isascii() and mark.isprintable():
                    continue
                with self.assertRaisesRegex(Error, "client_name must not hold control characters"):
                    Client(daemon.connect, name="anna" + mark)

    def test_a_body_is_refused_by_such_a_name(self):
        with Daemon("--clock", "lockstep") as daemon, Client(daemon.connect, role="admin") as admin:
            yaml = 'name: "box\\u202e"\nmass: 1\nshapes: [{box: [0.1, 0.1, 0.1]}]\n'
            with self.assertRaisesRegex(Error, "must not hold control characters"):
                admin.connection.request(add_body=pb.AddBody(yaml=yaml))

    def test_what_a_foreign_server_sends_is_shown_escaped(self):
        with ForeignServer() as server:
            for words in (["parts"], ["parts", "--names"], ["parts", "--json"], ["status"], ["status", "--json"],
                          ["describe", "arm"], ["describe", "arm", "--names"], ["describe", "arm", "--json"]):
                shown = visum(*words, "--connect", server.address).stdout
                self.assertFalse(set(shown) & set(EVIL[3:]) - set("2J[\n"), (words, shown))
                self.assertIn(r"\u202e" if "--json" in words else SAFE, shown)
            refused = visum("get", "arm", "--connect", server.address, expect=2).stderr
            self.assertEqual(refused, f"visum: {SAFE}\n".replace(r"\x0a", "\n"))


class ForeignServer:
    """Answers each client with the worst texts."""

    ANSWERS = {
        "list_parts": pb.ServerMessage(parts=pb.PartList(parts=[
            pb.PartSummary(name="arm"), pb.PartSummary(name=EVIL, kind=EVIL, lease_owner=EVIL)])),
        "status": pb.ServerMessage(status=pb.ServerStatus(clock=EVIL, free_running=[EVIL])),
    }

    def __enter__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.listener.close()

    def serve(self):
        with contextlib.suppress(OSError):
            while True:
                client, _ = self.listener.accept()
                with client, contextlib.suppress(OSError, struct.error):
                    while True:
                        self.answer(client)

    def answer(self, client):
        stream = client.makefile("rb")
        size, = struct.unpack("<I", stream.read(4))
        request = pb.ClientMessage.FromString(stream.read(size))
        kind = request.WhichOneof("request")
        reply = pb.ServerMessage(error=pb.Error(code=pb.ERROR_BAD_VALUE, text=EVIL))
        if kind == "hello":
            reply = pb.ServerMessage(welcome=pb.Welcome(version=1, server=EVIL, scene=EVIL, session=1, role=request.hello.role))
        elif kind == "describe_part":
            port = pb.PortDescription(name=EVIL, unit=EVIL)
            part = pb.PartDescription(name=EVIL, kind=EVIL, lease_owner=EVIL, sensor_outputs=[port])
            reply = pb.ServerMessage(part_description=part)
        else:
            reply = self.ANSWERS.get(kind, reply)
        reply.reply_to = request.id
        payload = reply.SerializeToString()
        client.sendall(struct.pack("<I", len(payload)) + payload)


class Certificate(WithCertificates):
    def test_its_name_forges_no_line(self):
        subject = "/CN=anna\nvisumd: error: forged\033[2J"
        self.sign("boss", subject=subject)
        tokens = self.folder / "tokens"
        tokens.write_text("admin CN=somebody else\n")
        tokens.chmod(0o600)
        with tempfile.TemporaryFile("w+") as log, Logged(*self.files("server"), "--token-file", tokens, stderr=log) as daemon:
            refused = daemon.visum("parts", *self.files("boss"), expect=1).stderr
            daemon.process.send_signal(signal.SIGTERM)
            daemon.process.wait(timeout=DEADLINE_S)
            log.seek(0)
            lines = log.read().splitlines()
        shown = r"the certificate of 'anna\x0avisumd: error: forged\x1b[2J' gives a role here"
        self.assertIn(shown, refused)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn(shown, lines[0])
