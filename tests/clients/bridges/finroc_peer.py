"""A Finroc peer of our own, as finstruct is one: it connects, reads the structure, follows values, writes ports and
calls the administration interface. It speaks serialization revision 0."""
import socket
import struct
import time

GREETING = b"Greetings! I am a Finroc TCP peer.\0"
MARK = b"\xcd"
PRIMARY, EXPRESS, BULK = 1, 2, 4
FINSTRUCT, WHOLE, SHARED = 3, 2, 1
PORT, INTERFACE, OUTPUT, ACCEPTS, READ_ONLY = 1 << 0, 1 << 2, 1 << 21, 1 << 13, 1 << 20
CHANGED, INITIAL = 1, 2
GRACE_S = 60  # a guard against hanging for ever


class Bytes:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values[0] if len(values) == 1 else values

    def text(self):
        end = self.data.index(0, self.at)
        text = self.data[self.at:end].decode()
        self.at = end + 1
        return text

    def more(self):
        return self.at < len(self.data)


class Types:
    """The types that the other side has described, by their number."""

    def __init__(self):
        self.names, self.choices, self.begun = {}, {}, False

    def take(self, data):
        number = data.take("h")
        if number == -2:
            if not self.begun:
                data.take("h")
            self.begun = True
            while (number := data.take("h")) != -1:
                data.take("hB")
                name, traits = data.text(), data.take("B")
                self.names[number] = name
                if traits & 8:
                    self.choices[name] = [data.text() for _ in range(data.take("h"))]
            number = data.take("h")
        return self.names[number]


class Element:
    def __init__(self, data, types):
        self.handle = data.take("i")
        links = data.take("B")
        assert links & 0x7f == 1, links
        self.name, _, self.parent = data.text(), data.take("B"), data.take("i")
        self.type, self.targets = "", []
        if links & 0x80:
            self.type = types.take(data)
            self.flags, self.strategy, self.interval = data.take("Ihh")
            self.targets = [data.take("iB")[0] for _ in range(data.take("B"))]
        else:
            self.flags = data.take("I")
        self.tags = []
        if data.take("B"):
            count, _ = data.take("IB")
            self.tags = [data.text() for _ in range(count)]


def number(value, unit=None):
    return bytes([0x86]) + struct.pack("<d", value) if unit is None else bytes([0x87]) + struct.pack("<dB", value, unit)


def take_value(data, kind, choices):
    if kind == "Number":
        first = data.take("b")
        code, unit = first >> 1, first & 1
        forms = {-64: "q", -63: "i", -62: "h", -61: "d", -60: "f"}
        value = data.take(forms[code]) if code in forms else code
        if unit:
            data.take("B")
        return value
    if kind == "bool":
        return bool(data.take("B"))
    if kind in choices:
        return choices[kind][data.take("B")]
    return data.text()


class Connection:
    def __init__(self, port, flags, wants, name):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=GRACE_S)
        body = b"peer\0" + struct.pack("<i", -1) + b"\0" + name.encode() + b"\0" + struct.pack("<BI", wants, flags)
        body += b"\0\x7f\0\0\1" + MARK
        self.socket.sendall(GREETING + struct.pack("<HI", 1, len(body)) + body)
        self.types = Types()
        assert self.read(len(GREETING)) == GREETING
        version, length = struct.unpack("<HI", self.read(6))
        assert version == 1, version
        data = Bytes(self.read(length))
        self.host, self.process, _, self.name = data.text(), data.take("i"), data.take("B"), data.text()
        data.take("B")
        self.flags = data.take("I")
        self.elements = []
        if flags & PRIMARY:
            while (size := struct.unpack("<I", self.read(4))[0]) != 0:
                packet = Bytes(self.read(size))
                while packet.more():
                    self.elements.append(Element(packet, self.types))
            self.socket.sendall(struct.pack("<I", 0))

    def read(self, count):
        data = b""
        while len(data) < count:
            more = self.socket.recv(count - len(data))
            if not more:
                raise ConnectionError("the bridge closed the connection")
            data += more
        return data

    def batch(self, messages, acknowledge=-1):
        self.socket.sendall(struct.pack("<Ihh", 4 + len(messages), acknowledge, -1) + messages)

    def next_batch(self):
        """The messages of one batch, as (code, Bytes), and the number that it acknowledges."""
        data = Bytes(self.read(struct.unpack("<I", self.read(4))[0]))
        _, acknowledged = data.take("hh")
        messages = []
        while data.more():
            code = data.take("B")
            size = 5 if code == 8 else data.take("I")
            messages.append((code, Bytes(data.data[data.at:data.at + size - 1])))
            data.at += size - 1
            assert data.take("B") == MARK[0]
        return messages, acknowledged

    def close(self):
        self.socket.close()


class Peer:
    """Two connections, as Finroc's tools have them."""

    def __init__(self, port, name="a peer"):
        self.structure = Connection(port, PRIMARY | BULK, FINSTRUCT, name)
        self.values = Connection(port, EXPRESS, 0, name)
        self.by_handle = {element.handle: element for element in self.structure.elements}
        self.by_path = {self.path(element): element for element in self.structure.elements}
        self.seen, self.described, self.call_id = {}, False, 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.structure.close()
        self.values.close()

    def path(self, element):
        above = self.by_handle.get(element.parent)
        return (self.path(above) if above else "") + "/" + element.name

    def await_structure(self, good):
        """Takes in what the bridge tells of the tree, until good(self)."""
        end = time.monotonic() + GRACE_S
        while not good(self):
            if time.monotonic() > end:
                raise TimeoutError(f"the tree stays {sorted(self.by_path)}")
            for code, data in self.structure.next_batch()[0]:
                if code == 6:
                    element = Element(data, self.structure.types)
                    self.by_handle[element.handle] = element
                    self.by_path[self.path(element)] = element
                elif code == 7:
                    element = self.by_handle[data.take("i")]
                    element.flags, element.strategy, element.interval = data.take("Ihh")
                    element.targets = [data.take("iB")[0] for _ in range(data.take("B"))]
                elif code == 8:
                    gone = self.by_handle.pop(data.take("i"))
                    self.by_path = {path: element for path, element in self.by_path.items() if element is not gone}

    def find(self, path):
        """The one port whose path ends with this."""
        found = [element for name, element in self.by_path.items() if name.endswith(path)]
        assert len(found) == 1, (path, len(found))
        return found[0]

    def subscribe(self, *elements, interval_ms=0):
        self.values.batch(b"".join(
            struct.pack("<BihBhiB", 0, e.handle, 1, 0, interval_ms, e.handle + 7, 0) + MARK for e in elements))

    def take_values(self):
        """Takes one batch in: the newest value of each port goes to `seen`, by handle. True if it acknowledges one."""
        messages, acknowledged = self.values.next_batch()
        for code, data in messages:
            if code != 10:
                continue
            handle, encoding = data.take("iB")
            assert encoding == 0, encoding
            element = self.by_handle[handle - 7]
            more = True
            while more:
                change, when = data.take("Bq")
                self.seen[element.handle] = take_value(data, element.type, self.structure.types.choices)
                more = data.take("B")
        return acknowledged >= 0

    def wait_for(self, element, good):
        """Takes batches in until good(value) of a subscribed port."""
        end = time.monotonic() + GRACE_S
        while element.handle not in self.seen or not good(self.seen[element.handle]):
            if time.monotonic() > end:
                raise TimeoutError(f"{element.name} stays {self.seen.get(element.handle)}")
            self.take_values()
        return self.seen[element.handle]

    def write(self, element, value, change=CHANGED):
        body = struct.pack("<iBBq", element.handle, 0, change, 0) + value + b"\0" + MARK
        self.values.batch(struct.pack("<BI", 10, len(body)) + body)

    def settle(self):
        """Returns once the bridge has taken in all that was written."""
        self.values.batch(b"", acknowledge=1)
        while not self.take_values():
            pass

    def call(self, method, arguments):
        """Calls the administration interface. Returns the status and the result."""
        handle = self.by_path["/Runtime/Services/Administration"].handle
        kind = struct.pack("<h", 0)
        if not self.described:
            kind = struct.pack("<hhhhB", -2, 40, 0, -1, 2) + b"Administration Interface\0" + struct.pack("<Bhh", 0, -1, 0)
        self.described = True
        self.call_id += 1
        body = struct.pack("<iB", handle, 1) + kind + struct.pack("<Bqq", method, self.call_id, 10**9) + arguments + MARK
        self.structure.batch(struct.pack("<BI", 4, len(body)) + body)
        while True:
            for code, data in self.structure.next_batch()[0]:
                if code != 4:
                    continue
                data.take("iB")
                self.structure.types.take(data)
                answered, call, _, status = data.take("BqBB")
                if (answered, call) == (method, self.call_id):
                    return status, data

    def apply(self, element, value):
        """As finstruct's Apply does: returns the error text, empty if the value was accepted."""
        buffer = b"\0" + value
        status, data = self.call(15, struct.pack("<iq", element.handle, len(buffer)) + buffer)
        assert status == 1, status
        return data.text()
