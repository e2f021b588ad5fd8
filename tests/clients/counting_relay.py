"""Stands where `visum run` looks for visumd: starts the real one, and counts the messages of each client on their way.

A message is here one segment of TCP with data, as the kernel of the receiver counts them (tcp(7), TCP_INFO). Nobody on this
way delays small writes, so a program that sends twice is counted twice, however late the relay reads. Whoever connects to
the relay is not on the Unix socket beside visumd's port, where the same bytes are written in the same way.

VISUM_COUNTS names the file for the counts: a line of JSON for each Advance of the client that VISUM_COUNTED names, with the
messages of each client up to then as [to the server, to the client].
"""
import json
import os
import selectors
import signal
import socket
import struct
import subprocess
import sys

sys.path.insert(0, os.environ["VISUM_PYTHON"])
from visum import visum_pb2 as pb

LENGTH = struct.Struct("<I")
DATA_SEGMENTS_IN = 152  # its place in struct tcp_info, which only grows at its end
CHUNK_BYTES = 1 << 20


def messages_at(end):
    info = end.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, 256)
    return struct.unpack_from("<I", info, DATA_SEGMENTS_IN)[0]


class Pair:
    """The two ends of the relay for one client."""

    def __init__(self, client, server):
        self.client, self.server, self.name, self.unread = client, server, "", b""
        for end in (client, server):
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def other(self, end):
        return self.server if end is self.client else self.client

    def counts(self):
        return [messages_at(self.client), messages_at(self.server)]

    def advances_in(self, data):
        """How many Advances of the client end in these bytes."""
        self.unread, advances = self.unread + data, 0
        while len(self.unread) >= LENGTH.size:
            end = LENGTH.size + LENGTH.unpack_from(self.unread)[0]
            if len(self.unread) < end:
                break
            message = pb.ClientMessage.FromString(self.unread[LENGTH.size:end])
            self.unread = self.unread[end:]
            advances += message.HasField("advance")
            if message.HasField("hello"):
                self.name = message.hello.client_name
        return advances


class Relay:
    def __init__(self, port, file):
        self.port, self.file, self.pairs = port, file, []
        self.door = socket.create_server(("127.0.0.1", 0))
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.door, selectors.EVENT_READ)

    def admit(self):
        pair = Pair(self.door.accept()[0], socket.create_connection(("127.0.0.1", self.port)))
        self.pairs.append(pair)
        for end in (pair.client, pair.server):
            self.selector.register(end, selectors.EVENT_READ, pair)

    def carry(self, pair, end):
        try:
            data = end.recv(CHUNK_BYTES)
            if data and end is pair.client:
                self.note(pair, pair.advances_in(data))
            pair.other(end).sendall(data)
        except OSError:  # a client or the server that ends may reset its connection
            data = b""
        if not data:
            self.pairs.remove(pair)
            for one in (pair.client, pair.server):
                self.selector.unregister(one)
                one.close()

    def note(self, pair, advances):
        if pair.name == os.environ["VISUM_COUNTED"]:
            for _ in range(advances):
                print(json.dumps({each.name: each.counts() for each in self.pairs}), file=self.file, flush=True)

    def run_until(self, ended):
        self.selector.register(ended, selectors.EVENT_READ)
        while True:
            for key, _ in self.selector.select():
                if key.fileobj == ended:
                    return
                if key.fileobj is self.door:
                    self.admit()
                elif key.data in self.pairs:
                    self.carry(key.data, key.fileobj)


def main():
    server = subprocess.Popen([os.environ["VISUM_REAL_VISUMD"], *sys.argv[1:]], stdout=subprocess.PIPE)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: server.terminate())
    ready = json.loads(server.stdout.readline())
    with open(os.environ["VISUM_COUNTS"], "w") as file:
        relay = Relay(ready["port"], file)
        ready["port"] = relay.door.getsockname()[1]
        print(json.dumps(ready), flush=True)
        relay.run_until(os.pidfd_open(server.pid))
    return server.wait()


if __name__ == "__main__":
    sys.exit(main())
