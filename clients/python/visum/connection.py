"""The TCP session: frames, replies in order, and the samples and events between them. protocol/SPEC.md describes it."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import time
from collections import deque
from typing import TYPE_CHECKING, NamedTuple

from visum.busy_wait import BusyWait
from visum.errors import Error, ErrorCode
from visum.messages import why_no_messages

try:
    from visum import visum_pb2 as pb
except ImportError as missing:
    raise ImportError(why_no_messages(missing)) from missing

from visum.request_bytes import LENGTH, frame, request_bytes  # noqa: E402 - needs pb

if TYPE_CHECKING:
    from google.protobuf.message import Message

VERSION = 1
MAX_FRAME_BYTES = 64 << 20
MAX_EVENTS = 1024
RETRY_PAUSE_S = 0.2  # after a server has closed a connection without a word
_CHUNK_BYTES = 65536  # of one recv()


def parse_address(text: str) -> tuple[str, int]:
    """"HOST:PORT", "[::1]:PORT" or "PORT"."""
    host, _, port = text.rpartition(":")
    if not port.isdigit() or not 0 < int(port) < 65536:
        raise Error(ErrorCode.MISUSE, f"'{text}' is not an address; give HOST:PORT")
    return host.strip("[]") or "127.0.0.1", int(port)


class TlsFiles(NamedTuple):
    """PEM files: the authority that signed the server's certificate, our own certificate, and its key."""

    ca: str | None = None
    cert: str | None = None
    key: str | None = None

    @staticmethod
    def of_environment() -> TlsFiles:
        return TlsFiles(*(os.environ.get(f"VISUM_TLS_{name}") or None for name in ("CA", "CERT", "KEY")))


def _secure(plain: socket.socket, address: str, files: TlsFiles) -> socket.socket:
    """Begins TLS 1.3 on a connection, with certificates on both sides."""
    import ssl  # here, because it takes a tenth of the time to import this package

    try:
        if not all(files):
            raise Error(ErrorCode.MISUSE, "TLS needs three files: tls_ca, tls_cert and tls_key")
        context = ssl.create_default_context(cafile=files.ca)
        context.minimum_version = ssl.TLSVersion.TLSv1_3
        context.load_cert_chain(files.cert, files.key)
        return context.wrap_socket(plain, server_hostname=parse_address(address)[0])
    except (OSError, ssl.SSLError) as error:
        plain.close()
        raise Error(ErrorCode.UNAUTHENTICATED, f"TLS with {address}: {error}") from error


def _dial_locally(address: str) -> socket.socket | None:
    """Connects to the Unix socket beside the port, where the server is a program of the same run (protocol/local_socket.h)."""
    host, port = parse_address(address)
    word = os.environ.get("VISUM_LOCAL")
    if not word or host != "127.0.0.1":
        return None
    connection = socket.socket(socket.AF_UNIX)
    connection.settimeout(5.0)  # also for the handshake
    try:
        connection.connect(f"\0visum-{word}-{port}")
    except OSError:  # nothing listens there
        connection.close()
        return None
    return connection


def _await_bytes(local: socket.socket) -> None:
    """Waits on a Unix socket, where recv() would also be woken when the server takes what we sent."""
    arrival = select.poll()  # a new one each time: a signal's handler may wait, too
    arrival.register(local, select.POLLIN)
    arrival.poll()


def _set_options(connection: socket.socket) -> None:
    """Makes frames leave at once, and finds a server that vanished silently after about 4 s: by probes while we send nothing,
    else by the time without an acknowledgement."""
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in (("TCP_KEEPIDLE", 1), ("TCP_KEEPINTVL", 1), ("TCP_KEEPCNT", 3), ("TCP_USER_TIMEOUT", 4000)):
        if hasattr(socket, name):  # not every system has all of them
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _dial(address: str) -> socket.socket:
    """Connects, in up to three attempts of 1, 2 and 4 s. The kernel repeats a lost request after 1, 3 and 7 s, so a new
    attempt finds a cable that is plugged in again sooner. The attempts grow longer for servers that answer slowly."""
    for attempt_s in (1.0, 2.0, 4.0):
        try:
            connection = socket.create_connection(parse_address(address), timeout=attempt_s)
            connection.settimeout(5.0)  # for the handshakes
            return connection
        except TimeoutError as error:
            timeout = error
    raise timeout


def _connect(address: str, patience_s: float) -> socket.socket:
    """Tries until something listens or the time is over. The pauses between the attempts double, up to 0.5 s."""
    end = time.monotonic() + patience_s
    pause = 0.01
    while True:
        try:
            return _dial(address)
        except OSError as error:
            if time.monotonic() + pause > end:
                raise Error(ErrorCode.CONNECTION, f"cannot connect to {address}: {error}") from error
        time.sleep(pause)
        pause = min(2 * pause, 0.5)


class Connection:
    """One session with a server, for one thread. The server answers requests in the order in which they are sent. A lost
    connection raises CONNECTION."""

    def __init__(self, address: str, hello: pb.Hello, patience_s: float, tls: TlsFiles = TlsFiles()) -> None:
        self._next_id = 1
        self._secure = any(tls)
        self._busy_wait = BusyWait()
        self._unsent = bytearray()
        self._received = bytearray()
        self._replies: dict[int, pb.ServerMessage] = {}
        self.events: deque[pb.Event] = deque(maxlen=MAX_EVENTS)
        self.latest_samples: dict[str, pb.PartSample] = {}  # of subscriptions, by part
        self.latest_world: pb.WorldSample | None = None
        end = time.monotonic() + patience_s
        while True:
            try:
                self.welcome: pb.Welcome = self._say_hello(address, hello, end - time.monotonic(), tls)
                break
            except Error as error:
                # A server that is flooded closes connections without a word; a later one may get its turn.
                self._received.clear()
                self._unsent.clear()
                if error.code != ErrorCode.CONNECTION or time.monotonic() + RETRY_PAUSE_S > end:
                    raise
            time.sleep(RETRY_PAUSE_S)
        self._socket.settimeout(None)

    def _say_hello(self, address: str, hello: pb.Hello, patience_s: float, tls: TlsFiles) -> pb.Welcome:
        local = None if self._secure else _dial_locally(address)
        self._socket = local or _connect(address, patience_s)
        self._is_local = local is not None
        try:
            if not local:
                _set_options(self._socket)
            if self._secure:
                self._socket = _secure(self._socket, address, tls)
            return self.request(hello=hello).welcome
        except BaseException:
            self._socket.close()
            raise

    def close(self) -> None:
        """Ends the session. Leases that were not released count as lost."""
        if self._unsent and not self.closed:
            with contextlib.suppress(Error):  # the connection is gone, and the requests with it
                self.flush()
        self._socket.close()

    @property
    def closed(self) -> bool:
        return self._socket.fileno() < 0

    @property
    def requests(self) -> int:
        """How many were made so far, also those that wait to be sent."""
        return self._next_id - 1

    def send(self, **request: Message) -> int:
        """Sends one request, named as in ClientMessage, and returns the number for take() or wait()."""
        number = self.send_along(request_bytes(**request))
        self.flush()
        return number

    def send_along(self, request: bytes) -> int:
        """As send() of what request_bytes() has made, but it leaves with the next request that send() sends, or at the next
        wait."""
        number = self._next_id
        self._next_id += 1
        self._unsent += frame(number, request)
        return number

    def flush(self) -> None:
        """Sends what send_along() has kept. After a failure nothing is sent again, because some of it may have left."""
        leaving, self._unsent = self._unsent, bytearray()
        try:
            self._socket.sendall(leaving)
        except OSError as error:
            raise Error(ErrorCode.CONNECTION, f"the connection is gone: {error}") from error

    def take(self, number: int) -> pb.ServerMessage:
        """Waits for the reply to a request. It may be a refusal."""
        if self._unsent:
            self.flush()
        while number not in self._replies:
            self._sort(self._receive())
        return self._replies.pop(number)

    def wait(self, number: int) -> pb.ServerMessage:
        """Waits for the reply to a request. A refusal raises."""
        reply = self.take(number)
        if refusal := refusal_of(reply):
            raise refusal
        return reply

    def request(self, **request: Message) -> pb.ServerMessage:
        return self.wait(self.send(**request))

    def poll(self) -> None:
        """Reads what has arrived, without waiting."""
        if self._unsent:
            self.flush()
        self._socket.setblocking(False)
        try:
            while True:
                self._sort(self._receive())
        except BlockingIOError:
            pass
        finally:
            if not self.closed:
                self._socket.settimeout(None)

    def _sort(self, message: pb.ServerMessage) -> None:
        if message.reply_to != 0:
            self._replies[message.reply_to] = message
            return
        kind = message.WhichOneof("body")
        if kind == "part_sample":
            self.latest_samples[message.part_sample.part] = message.part_sample
        elif kind == "world_sample":
            self.latest_world = message.world_sample
        elif kind == "event":
            self.events.append(message.event)
        elif kind == "error":
            raise _to_error(message.error)  # an error without a request: the reason why the server closes

    def _receive(self) -> pb.ServerMessage:
        received = self._received
        if len(received) < LENGTH.size:
            self._fill(LENGTH.size)
        (length,) = LENGTH.unpack_from(received)
        if length > MAX_FRAME_BYTES:
            self.close()
            raise Error(ErrorCode.TOO_LARGE, f"the server sent a frame of {length} bytes; the limit is {MAX_FRAME_BYTES}")
        end = LENGTH.size + length
        if len(received) < end:
            self._fill(end)
        message = pb.ServerMessage.FromString(bytes(received[LENGTH.size:end]))
        del received[:end]
        return message

    def _fill(self, size: int) -> None:
        """Receives until at least `size` bytes are there."""
        while len(self._received) < size:
            try:
                chunk = self._receive_bytes()
            except BlockingIOError:
                raise
            except OSError as error:
                raise self._trouble(error) from error
            if not chunk:
                raise Error(ErrorCode.CONNECTION, "the server closed the connection")
            self._received += chunk

    def _receive_bytes(self) -> bytes:
        """As recv(). A wait without a time limit looks busily first."""
        if not self._secure and self._socket.gettimeout() is None:
            found = self._busy_wait.receive(self._socket, _CHUNK_BYTES)
            if found is not None:
                return found
            if self._is_local and not self.closed:
                _await_bytes(self._socket)
        return self._socket.recv(_CHUNK_BYTES)

    def _trouble(self, error: OSError) -> Exception:
        """Translates an error of recv(): BlockingIOError where TLS needs more bytes, else the connection's end."""
        if self._secure:
            import ssl

            if isinstance(error, ssl.SSLWantReadError):
                return BlockingIOError()
            if isinstance(error, ssl.SSLError):  # the server did not accept our certificate
                return Error(ErrorCode.UNAUTHENTICATED, f"TLS: {error}")
        return Error(ErrorCode.CONNECTION, f"the connection is gone: {error}")


def refusal_of(reply: pb.ServerMessage) -> Error | None:
    return _to_error(reply.error) if reply.WhichOneof("body") == "error" else None


def _to_error(error: pb.Error) -> Error:
    known = error.code in ErrorCode.__members__.values()
    return Error(ErrorCode(error.code) if known else ErrorCode.UNSPECIFIED, error.text, error.owner)
