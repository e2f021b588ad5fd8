"""The HTTP port over TLS, with Python's own clients: who gets the page and a session, and what the others are told."""
import base64
import contextlib
import http.client
import os
import select
import socket
import ssl
import struct
import subprocess
import sys
import unittest

from certificates import WithCertificates
from programs import ARM, BIN, DEADLINE_S, Daemon, visum

sys.path.insert(0, str(BIN.parent / "python"))
from visum import visum_pb2 as pb  # noqa: E402

ADMIN, OBSERVER = pb.ROLE_ADMIN, pb.ROLE_OBSERVER


class Session:
    """A session over WebSocket (RFC 6455) on a socket, as a page begins one."""

    def __init__(self, stream, port, origin):
        self.stream = stream
        key = base64.b64encode(os.urandom(16)).decode()
        stream.sendall((f"GET /session HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: {origin}\r\nUpgrade: websocket\r\n"
                        f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
                        "Sec-WebSocket-Protocol: visum.v1\r\n\r\n").encode())
        self.received = b""
        while b"\r\n\r\n" not in self.received:
            self.fill()
        head, self.received = self.received.split(b"\r\n\r\n", 1)
        self.status = int(head.split()[1])

    def fill(self):
        chunk = self.stream.recv(65536)
        if not chunk:
            raise EOFError("the server closed the connection")
        self.received += chunk

    def take(self, size):
        while len(self.received) < size:
            self.fill()
        taken, self.received = self.received[:size], self.received[size:]
        return taken

    def send(self, payload, opcode=2):
        mask = os.urandom(4)
        length = bytes([0x80 | len(payload)]) if len(payload) < 126 else b"\xfe" + struct.pack(">H", len(payload))
        self.stream.sendall(bytes([0x80 | opcode]) + length + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(payload)))

    def message(self):
        """The next frame: its kind and what it holds."""
        kind, size = self.take(2)
        if size >= 126:
            size, = struct.unpack(">H", self.take(2)) if size == 126 else struct.unpack(">Q", self.take(8))
        return kind & 0x0F, self.take(size)

    def ask(self, number, **request):
        payload = pb.ClientMessage(id=number, **request).SerializeToString()
        self.send(struct.pack("<I", len(payload)) + payload)
        read = b""
        while True:
            while len(read) < 4 or len(read) < 4 + struct.unpack_from("<I", read)[0]:
                kind, text = self.message()
                if kind == 9:
                    self.send(text, opcode=10)  # a pong, as a browser gives
                elif kind == 8:
                    raise EOFError("the server closed the session")
                else:
                    read += text
            size = 4 + struct.unpack_from("<I", read)[0]
            reply, read = pb.ServerMessage.FromString(read[4:size]), read[size:]
            if reply.reply_to == number:
                return reply

    def hello(self, role, token=""):
        return self.ask(1, hello=pb.Hello(min_version=1, max_version=1, client_name="page", role=role, token=token.encode()))


class Viewer(Daemon):
    """A recording on the page."""

    def __init__(self, file, *options):
        self.command = [str(BIN / "visum"), "replay", str(file), "--view", "--json", *map(str, options)]


class Https(WithCertificates):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sign("old", days=-1)
        cls.sign_itself("boss", "other")

    def doors(self):
        tokens = self.folder / "tokens"
        tokens.write_text("admin CN=boss\nobserver CN=camera\ncontroller tokens-work-too-01\n")
        tokens.chmod(0o600)
        return ("--http", "0", *self.files("server"), "--token-file", tokens)

    def daemon(self, *options):
        return Daemon("--clock", "lockstep", *self.doors(), *options)

    def context(self, name=None):
        context = ssl.create_default_context(cafile=self.folder / "ca.pem")
        if name:
            context.load_cert_chain(self.folder / f"{name}.pem", self.folder / f"{name}.key")
        return context

    def connect(self, daemon, name):
        plain = socket.create_connection(("127.0.0.1", daemon.ready["http"]), timeout=DEADLINE_S)
        return self.context(name).wrap_socket(plain, server_hostname="127.0.0.1")

    def secure(self, daemon, name):
        return http.client.HTTPSConnection("127.0.0.1", daemon.ready["http"], timeout=DEADLINE_S, context=self.context(name))

    def get(self, daemon, path, name, **headers):
        with contextlib.closing(self.secure(daemon, name)) as connection:
            connection.request("GET", path, headers=headers)
            answer = connection.getresponse()
            return answer.status, answer.read()

    def session(self, daemon, name, scheme="https"):
        port = daemon.ready["http"]
        session = Session(self.connect(daemon, name), port, f"{scheme}://127.0.0.1:{port}")
        self.addCleanup(session.stream.close)
        return session

    def test_a_certificate_gets_the_page(self):
        page = self.folder / "page"
        (page / "assets").mkdir(parents=True, exist_ok=True)
        (page / "index.html").write_text("<!doctype html>")
        script = os.urandom(1 << 20)  # more than sockets hold
        (page / "assets" / "index-0a1b2c3d.js").write_bytes(script)
        with self.daemon("--page", page) as daemon:
            self.assertEqual(daemon.ready["page"], f"https://127.0.0.1:{daemon.ready['http']}/")
            self.assertEqual(self.get(daemon, "/", "boss"), (200, b"<!doctype html>"))
            self.assertEqual(self.get(daemon, "/assets/index-0a1b2c3d.js", "boss"), (200, script))
            with contextlib.closing(self.secure(daemon, "boss")) as kept:
                for _ in range(3):  # requests on one connection
                    kept.request("GET", "/healthz")
                    self.assertEqual(kept.getresponse().read(), b"ok\n")

    def test_names_and_tokens_decide_what_is_told(self):
        with self.daemon() as daemon:
            self.assertEqual(self.get(daemon, "/metrics", "camera")[0], 200)
            self.assertEqual(self.get(daemon, "/metrics", "server")[0], 401, "it has no role")
            self.assertEqual(self.get(daemon, "/metrics", "server", Authorization="Bearer tokens-work-too-01")[0], 200)

    def test_a_session_has_the_role_of_the_name(self):
        with self.daemon() as daemon:
            boss = self.session(daemon, "boss")
            self.assertEqual(boss.status, 101)
            self.assertEqual(boss.hello(ADMIN).welcome.role, ADMIN)
            boss.ask(2, pause=pb.Pause())
            self.assertEqual(boss.ask(3, step=pb.Step(ticks=5)).advanced.tick, 5)
            self.assertEqual(boss.ask(4, status=pb.Status()).status.tick, 5)
            self.assertGreater(len(boss.ask(5, describe_world=pb.DescribeWorld()).world_description.bodies), 5)
            self.assertEqual(self.session(daemon, "camera").hello(ADMIN).welcome.role, OBSERVER)
            refused = self.session(daemon, "server").hello(ADMIN).error
            self.assertEqual((refused.code, refused.text),
                             (pb.ERROR_UNAUTHENTICATED, "neither a token nor the certificate of 'server' gives a role here"))
            self.assertEqual(self.session(daemon, "server").hello(ADMIN, "tokens-work-too-01").welcome.role, pb.ROLE_CONTROLLER)

    def test_closing_handshakes_end_in_a_goodbye_of_tls(self):
        with self.daemon() as daemon:
            session = self.session(daemon, "boss")
            session.hello(ADMIN)
            session.send(struct.pack(">H", 1000), opcode=8)
            self.assertEqual(session.message(), (8, struct.pack(">H", 1000)))
            self.assertEqual(session.stream.recv(1), b"", "ended in good order: else this raises")

    def test_a_recording_is_shown_by_the_same_rules(self):
        file = self.folder / "run.mcap"
        visum("record", file, ARM, "--clock", "free", "--run", "--iterations", 20, "--port", 0, "--http", "off")
        refused = visum("replay", file, "--view", "--listen", "0.0.0.0", expect=2)
        self.assertIn("--listen 0.0.0.0 is open to others than this machine: that needs --token-file", refused.stderr)
        self.assertIn("--listen requires --view", visum("replay", file, "--listen", "127.0.0.1", expect=2).stderr)
        with Viewer(file, "--listen", "0.0.0.0", *self.doors()) as viewer:
            self.assertEqual(viewer.ready["page"], f"https://localhost:{viewer.ready['http']}/")
            self.assertEqual(self.get(viewer, "/healthz", "boss"), (200, b"ok\n"))
            self.assertEqual(self.get(viewer, "/metrics", "server")[0], 401, "it has no role")
            self.assertEqual(self.get(viewer, "/recording/ports/0/5/5", "server")[0], 401, "nor may it read ports")
            self.assertEqual(self.get(viewer, "/recording/ports/0/5/5", "boss")[0], 200)
            boss = self.session(viewer, "boss")
            self.assertEqual(boss.hello(ADMIN).welcome.role, ADMIN)
            parameters = boss.ask(2, get_parameters=pb.GetParameters(part="recording")).parameters.parameters
            self.assertEqual([(p.name, p.maximum) for p in parameters], [("Position", 20)])

    def test_pages_of_other_origins_get_no_session(self):
        with self.daemon() as daemon:
            self.assertEqual(self.session(daemon, "boss", scheme="http").status, 403)

    def test_who_shows_no_good_certificate_is_told_why(self):
        with self.daemon() as daemon:
            for name, why in ((None, "CERTIFICATE_REQUIRED"), ("old", "CERTIFICATE_EXPIRED"), ("other", "UNKNOWN_CA")):
                with self.subTest(why), self.assertRaises(ssl.SSLError) as refused:
                    self.get(daemon, "/", name)
                self.assertIn(why, str(refused.exception))
            self.assertEqual(self.get(daemon, "/healthz", "boss"), (200, b"ok\n"), "it goes on")

    def refused(self, port):
        """A socket on which TLS was begun without a certificate, and the alert that answered."""
        plain = socket.create_connection(("127.0.0.1", port), timeout=DEADLINE_S)
        self.addCleanup(plain.close)
        incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
        tls = self.context().wrap_bio(incoming, outgoing, server_hostname="127.0.0.1")

        def receive():
            plain.sendall(outgoing.read())
            received = plain.recv(65536)
            self.assertNotEqual(received, b"", "the server closed before it said why")
            incoming.write(received)
        while True:
            try:
                tls.do_handshake()
                # The client is content: it does not know yet that its lack of a certificate is an error
                break
            except ssl.SSLWantReadError:
                receive()
        while True:
            receive()
            try:
                tls.read()
            except ssl.SSLWantReadError:
                continue
            except ssl.SSLError as error:
                return plain, str(error)

    def test_a_refused_connection_stays_open_until_the_client_has_read_why(self):
        # A browser that reads the alert and finds the connection ended before it wrote its request reports
        # "not connected", and drops the reason.
        with self.daemon() as daemon:
            for door in ("http", "port"):
                with self.subTest(door):
                    plain, why = self.refused(daemon.ready[door])
                    self.assertIn("CERTIFICATE_REQUIRED", why)
                    self.assertEqual(select.select([plain], [], [], 0.3)[0], [], "it has not ended yet")
                    for _ in range(32):
                        plain.sendall(b"\x17\x03\x03" + bytes(4093))  # a late request: no reset
                    self.assertEqual(plain.recv(1), b"", "who never closes is let go, in good order")
            self.assertEqual(self.get(daemon, "/healthz", "boss"), (200, b"ok\n"), "it goes on")

    def test_a_refused_client_that_never_stops_writing_is_cut_off(self):
        with self.daemon() as daemon:
            for door in ("http", "port"):
                with self.subTest(door), self.assertRaises(OSError):
                    plain, why = self.refused(daemon.ready[door])
                    for _ in range(1 << 16):  # 4 GB at most
                        plain.sendall(bytes(1 << 16))

    def test_nothing_older_than_1_3_is_spoken(self):
        context = self.context("boss")
        context.maximum_version = ssl.TLSVersion.TLSv1_2
        with self.daemon() as daemon:
            with socket.create_connection(("127.0.0.1", daemon.ready["http"]), timeout=DEADLINE_S) as plain:
                with self.assertRaisesRegex(ssl.SSLError, "PROTOCOL_VERSION"):
                    context.wrap_socket(plain, server_hostname="127.0.0.1")

    def test_plain_http_is_told_that_https_is_spoken(self):
        with self.daemon() as daemon:
            plain = http.client.HTTPConnection("127.0.0.1", daemon.ready["http"], timeout=DEADLINE_S)
            with contextlib.closing(plain) as connection:
                connection.request("POST", "/", body=b"x" * 100_000)
                answer = connection.getresponse()
                self.assertEqual(answer.status, 400)
                self.assertIn("ask for https://", answer.read().decode())

    def test_who_begins_and_says_no_more_is_let_go(self):
        with self.daemon() as daemon:
            with socket.create_connection(("127.0.0.1", daemon.ready["http"]), timeout=DEADLINE_S) as silent:
                silent.sendall(b"\x16\x03\x01\x02\x00\x01")
                self.assertEqual(silent.recv(1), b"", "after the time that a hello may take")

    def test_the_log_names_who_is_refused_and_the_address_of_the_page(self):
        command = [str(BIN / "visumd"), *self.daemon().command[1:]]
        command[command.index("-v") + 1] = "2"
        command.remove("--json")
        with subprocess.Popen(command, stderr=subprocess.STDOUT, stdout=subprocess.PIPE, text=True) as process:
            page = next(line for line in process.stdout if "the page: " in line)
            port = int(page.rsplit(":", 1)[1].rstrip("/\n"))
            self.assertIn(f"https://127.0.0.1:{port}/", page)
            with socket.create_connection(("127.0.0.1", port), timeout=DEADLINE_S) as plain:
                plain.sendall(b"GET / HTTP/1.1\r\n\r\n")
                plain.recv(1)
            line = next(line for line in process.stdout if "is refused" in line)
            self.assertIn("plain HTTP, where https is spoken", line)
            process.terminate()


if __name__ == "__main__":
    unittest.main()
