"""Clothlab from Python: one file, which the server itself serves, so that it fits the server.

    curl -O http://127.0.0.1:8080/clothlab.py

    import clothlab
    with clothlab.connect("127.0.0.1:8080", session="script") as cloth:
        cloth["/gravity"] = [0, -1.6, 0]
        for frame in cloth.frames(rate=10):
            print(frame.time, frame.positions[:, 1].min())

Python 3.9 or newer and its standard library; frames as arrays need NumPy. Calls are synchronous: a thread reads what
the server sends, acknowledges its frames and keeps only the newest, so that a slow script sees no old ones.

Units are SI: m, s, kg, N; right-handed, y up; indices from 0. A pointer is a JSON Pointer (RFC 6901) into the scene:
"/cloths/0/material/bend". What goes wrong is a ClothlabError, whose text says where, what was found and what is
allowed.
"""

from __future__ import annotations

import base64
import collections
import contextlib
import hashlib
import html as html_module
import http.client
import json
import math
import os
import socket
import ssl
import struct
import threading
import time
import traceback
import urllib.error
import urllib.parse
import urllib.request
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping, Sequence, Union

if TYPE_CHECKING:
    import numpy

__all__ = ["connect", "html", "Session", "Frame", "Topology", "Hand", "Page", "ClothlabError", "Refused",
           "ConnectionLost", "Timeout"]

Json = Any
Verify = Union[bool, str, ssl.SSLContext]

SUBPROTOCOL = "clothlab.v1"
RETRY_TIME = 0.5  # [s] between two tries to connect anew
# The most that is taken from a server, whatever it sends.
MOST_HEAD_BYTES = 64 * 1024  # of the answer to the handshake
MOST_MESSAGE_BYTES = 64 * 1024 * 1024  # of a message: a million vertices have less
MOST_ANSWER_BYTES = 512 * 1024 * 1024  # over HTTP: a picture, or a mesh as text
MOST_HEARD = 10_000  # notifications that wait for wait(), or a measurement; beyond, the oldest are forgotten


class ClothlabError(Exception):
    """Anything that goes wrong here; its text is for people."""


class Refused(ClothlabError):
    """The server answered a request with an error. Nothing of the running scene has changed.

    code: of JSON-RPC: -32601 no such method, -32602 a wrong value, -32001 not allowed, -32002 over a limit,
        -32003 the scene has another revision, -32004 diverged.
    path, found, allowed: of a wrong value: its JSON Pointer, what was there, what may be there; else "".
    data: all that the server said, e.g. {"revision": 7}; {} if nothing.
    """

    def __init__(self, error: Mapping[str, Json]) -> None:
        super().__init__(error.get("message", "the server refused this"))
        self.code: int = error.get("code", 0)
        data = error.get("data")
        self.data: dict[str, Json] = data if isinstance(data, dict) else {}
        self.path: str = self.data.get("path", "")
        self.found: str = self.data.get("found", "")
        self.allowed: Json = self.data.get("allowed", "")


class ConnectionLost(ClothlabError):
    """No connection to the server; `reconnect()` makes it anew. code: the WebSocket's, or the status of HTTP."""

    def __init__(self, text: str, code: int = 0) -> None:
        super().__init__(text)
        self.code = code


class Timeout(ClothlabError):
    """The server did not answer in time; the connection stays as it is."""


# ------------------------------------------------------------------------------------------------- where the server is


class _Address:
    """Of "127.0.0.1:8080", or the page's address as the browser shows it, with its ?session=NAME."""

    def __init__(self, address: str, session: str | None, token: str | None, verify: Verify) -> None:
        url = urllib.parse.urlsplit(address if "//" in address else "http://" + address)
        secure = {"http": False, "ws": False, "https": True, "wss": True}.get(url.scheme)
        if secure is None or not url.hostname:
            raise ValueError(f"{address!r} is no address of a server; give one like 'http://127.0.0.1:8080'")
        self.secure: bool = secure
        self.host: str = url.hostname
        self.port: int = url.port or (443 if secure else 80)
        named = urllib.parse.parse_qs(url.query).get("session", ["main"])[0]
        self.session: str = named if session is None else session
        self.token = token
        self.context: ssl.SSLContext | None = None
        if secure and isinstance(verify, ssl.SSLContext):
            self.context = verify
        elif secure:
            self.context = ssl.create_default_context(cafile=verify if isinstance(verify, str) else None)
            if verify is False:
                self.context.check_hostname, self.context.verify_mode = False, ssl.CERT_NONE

    @property
    def authority(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"

    def url(self, path: str, **query: Json) -> str:
        scheme = "https" if self.secure else "http"
        return f"{scheme}://{self.authority}{path}?{urllib.parse.urlencode({'session': self.session, **query})}"


# --------------------------------------------------------------------------------- a client of RFC 6455, what we use


def _masked(data: bytes, mask: bytes) -> bytes:
    repeated = mask * (len(data) // 4 + 1)
    mixed = int.from_bytes(data, "big") ^ int.from_bytes(repeated[: len(data)], "big")
    return mixed.to_bytes(len(data), "big")


class _WebSocket:
    TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10

    def __init__(self, address: _Address, timeout: float) -> None:
        try:
            plain = socket.create_connection((address.host, address.port), timeout)
            plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.socket = (address.context.wrap_socket(plain, server_hostname=address.host) if address.context
                           else plain)
        except OSError as error:
            raise ConnectionLost(f"no server answers at {address.authority}: {error}") from error
        self.sending = threading.Lock()
        self.stream = self.socket.makefile("rb")
        try:
            self._shake_hands(address)
        except Exception as error:
            self.abandon()
            self.stream.close()
            if isinstance(error, ConnectionLost):
                raise
            raise ConnectionLost(f"{address.authority} did not finish the handshake: {error}") from error
        self.socket.settimeout(None)

    def _shake_hands(self, address: _Address) -> None:
        key = base64.b64encode(os.urandom(16)).decode()
        where = "/ws?" + urllib.parse.urlencode({"session": address.session})
        self.socket.sendall(
            f"GET {where} HTTP/1.1\r\nHost: {address.authority}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: {SUBPROTOCOL}\r\n\r\n"
            .encode("ascii"))
        first = self.stream.readline(MOST_HEAD_BYTES)
        status, left = first.split(b" ", 2), MOST_HEAD_BYTES - len(first)
        headers: dict[str, str] = {}
        while left > 0 and (line := self.stream.readline(left)) not in (b"\r\n", b"\n", b""):
            left -= len(line)
            name, _, value = line.decode("latin-1").partition(":")
            headers[name.strip().lower()] = value.strip()
        if left <= 0:
            raise ConnectionLost(f"{address.authority} answers with more than {MOST_HEAD_BYTES} bytes of headers; "
                                 "is it a Clothlab server?")
        code = int(status[1]) if len(status) > 1 and status[1].isdigit() else 0
        if code != 101:
            length = min(max(int(headers.get("content-length", 0)), 0), 4096)
            why = self.stream.read(length).decode("utf-8", "replace").strip()
            raise ConnectionLost(f"{address.authority} refused the connection ({code}): {why}", code)
        proof = hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()
        if headers.get("sec-websocket-accept") != base64.b64encode(proof).decode():
            raise ConnectionLost(f"{address.authority} is no WebSocket server: its answer to the key is wrong", code)

    def send(self, data: bytes, opcode: int = TEXT) -> None:
        size, mask = len(data), os.urandom(4)
        if size < 126:
            head = struct.pack("!BB", 0x80 | opcode, 0x80 | size)
        elif size < 65536:
            head = struct.pack("!BBH", 0x80 | opcode, 0x80 | 126, size)
        else:
            head = struct.pack("!BBQ", 0x80 | opcode, 0x80 | 127, size)
        with self.sending:
            self.socket.sendall(head + mask + _masked(data, mask))

    def _read(self, size: int) -> bytes:
        data = self.stream.read(size)
        if len(data) < size:
            raise ConnectionLost("the connection broke off", 1006)
        return data

    def receive(self) -> tuple[int, bytes]:
        """The next whole message, its opcode first. Raises ConnectionLost when the server closes."""
        message, kind = bytearray(), 0
        while True:
            first, second = self._read(2)
            opcode, size = first & 15, second & 127
            if size == 126:
                (size,) = struct.unpack("!H", self._read(2))
            elif size == 127:
                (size,) = struct.unpack("!Q", self._read(8))
            if len(message) + size > MOST_MESSAGE_BYTES or (opcode & 8 and size > 125):
                raise ConnectionLost(f"the server sends a message of more than {MOST_MESSAGE_BYTES} bytes, or a long "
                                     "control frame; is it a Clothlab server?", 1009)
            data = self._read(size)
            if opcode == self.PING:
                self.send(data, self.PONG)
            elif opcode == self.CLOSE:
                code = struct.unpack("!H", data[:2])[0] if size >= 2 else 1005
                why = data[2:].decode("utf-8", "replace")
                raise ConnectionLost(f"the server closed the connection ({code}): {why}", code)
            elif opcode != self.PONG:
                kind = opcode or kind  # 0: goes on with what came before
                message += data
                if first & 0x80:
                    return kind, bytes(message)

    def abandon(self) -> None:
        try:
            self.socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.socket.close()

    def close(self) -> None:
        try:
            self.send(struct.pack("!H", 1000), self.CLOSE)
        except OSError:
            pass
        self.abandon()


# -------------------------------------------------------------------------------------------------------------- frames


def _numpy() -> Any:
    try:
        import numpy as found
    except ImportError:
        raise ClothlabError("frames as arrays need NumPy: apt-get install python3-numpy, or pip install numpy; "
                            "all else works without, also a frame's `payload`") from None
    return found


class Topology:
    """What is connected: the same for all frames until another mesh.

    vertices: how many. cloths: a slice of the vertices for each cloth. payload: the bytes as they came.
    """

    def __init__(self, data: bytes) -> None:
        self.revision, self.vertices = struct.unpack_from("<I4xI", data, 4)
        count, cloths = struct.unpack_from("<II", data, 64)
        self.payload = data[64:]
        ranges = struct.iter_unpack("<II", data[72 : 72 + 8 * cloths])
        self.cloths = [slice(first, first + vertices) for first, vertices in ranges]
        self._at = 8 + 8 * cloths
        self._count = count
        if len(self.payload) != self._at + 12 * count + 8 * self.vertices:
            raise ClothlabError("a topology that is not as long as it says; fetch the server's own client")

    @property
    def triangles(self) -> numpy.ndarray:
        """(m, 3) uint32: the vertices of each triangle, counter-clockwise seen from where its normal points."""
        return _numpy().frombuffer(self.payload, "<u4", 3 * self._count, self._at).reshape(-1, 3)

    @property
    def texture(self) -> numpy.ndarray:
        """(n, 2) float32: texture coordinates."""
        at = self._at + 12 * self._count
        return _numpy().frombuffer(self.payload, "<f4", 2 * self.vertices, at).reshape(-1, 2)


class Frame:
    """The cloth at one moment.

    time [s], step; vertices: how many; sequence: the frame's number; encoding: "f32" or "q16"; asleep: nothing moves;
    diverged: it has blown up, and this is the last good state; topology; payload: the bytes as they came.
    """

    def __init__(self, data: bytes, topology: Topology) -> None:
        encoding, flags, _, self.sequence, self.vertices, self.time, self.step = struct.unpack_from("<xBHIIIdQ", data)
        if encoding > 1:
            raise ClothlabError(f"a frame of encoding {encoding}, unknown to this client: fetch the server's own")
        self._low, self._extent = struct.unpack_from("<3f", data, 32), struct.unpack_from("<3f", data, 44)
        (self._range,) = struct.unpack_from("<f", data, 60)
        self.encoding = ("f32", "q16")[encoding]
        self.asleep, self.diverged = bool(flags & 1), bool(flags & 2)
        self.topology = topology
        self.payload = data[64:]
        if len(self.payload) != ((24, 8)[encoding] + (self._range > 0)) * self.vertices:
            raise ClothlabError("a frame that is not as long as it says; fetch the server's own client")

    @property
    def positions(self) -> numpy.ndarray:
        """(n, 3) float32 [m]. Of q16 within 1/131070 of the extent of the cloth's box."""
        np = _numpy()
        if self.encoding == "f32":
            return np.frombuffer(self.payload, "<f4", 6 * self.vertices).reshape(-1, 6)[:, :3]
        words = np.frombuffer(self.payload, "<u2", 4 * self.vertices).reshape(-1, 4)[:, :3]
        step = np.array(self._extent, np.float64) / 65535
        return (np.array(self._low, np.float64) + step * words).astype(np.float32)

    @property
    def normals(self) -> numpy.ndarray:
        """(n, 3) float32, of length 1. Of q16 within a degree."""
        np = _numpy()
        if self.encoding == "f32":
            return np.frombuffer(self.payload, "<f4", 6 * self.vertices).reshape(-1, 6)[:, 3:]
        folded = np.frombuffer(self.payload, "i1", 8 * self.vertices).reshape(-1, 8)[:, 6:].astype(np.float32)
        xy = np.maximum(folded / 127, -1)
        z = 1 - abs(xy).sum(axis=1, keepdims=True)
        # The octahedron |x| + |y| + |z| = 1 unfolded to the square, its lower half turned outwards.
        turned = (1 - abs(xy[:, ::-1])) * np.where(xy >= 0, 1, -1)
        normals = np.hstack([np.where(z < 0, turned, xy), z])
        return (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)

    @property
    def field(self) -> numpy.ndarray | None:
        """(n,) float32: the field that was asked for, in 255 levels; None without one."""
        if self._range == 0:
            return None
        np = _numpy()
        levels = np.frombuffer(self.payload, "u1", self.vertices, len(self.payload) - self.vertices)
        return levels.astype(np.float32) * (self._range / 255)

    @property
    def triangles(self) -> numpy.ndarray:
        """(m, 3) uint32, those of the topology."""
        return self.topology.triangles


# ------------------------------------------------------------------------------------------------------------ a session


class Hand:
    """Pulls a vertex until `release()`, or the end of a with block."""

    def __init__(self, session: Session, hand: int) -> None:
        self.session, self.number = session, hand

    def move(self, target: Sequence[float]) -> None:
        """Pulls it to this place [m]."""
        self.session.request("grab.move", {"target": list(target), "hand": self.number})

    def release(self) -> None:
        self.session.request("grab.end", {"hand": self.number})

    def __enter__(self) -> Hand:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


class Page:
    """The live page, for a notebook's cell: an iframe."""

    def __init__(self, url: str, height: int) -> None:
        self.url, self.height = url, height

    def _repr_html_(self) -> str:
        url = html_module.escape(self.url, quote=True)
        return (f'<iframe src="{url}" title="Clothlab" allow="fullscreen" width="100%" height="{self.height}" '
                f'style="border:0"></iframe><p><a href="{url}" target="_blank" rel="noopener">In a tab of its own</a>. '
                "An empty frame? Start the server with <code>--allow-origin</code> and this notebook's origin, "
                "such as http://localhost:8888.</p>")


def html(session: str = "main", address: str = "http://127.0.0.1:8080", height: int = 480) -> Page:
    """The page of a session, live in the cell of a notebook; height [pixels]. The server must allow the notebook's
    origin: `clothlab serve --allow-origin http://localhost:8888`. It asks for the token itself."""
    return Page(_Address(address, session, None, True).url("/"), height)


def connect(address: str = "http://127.0.0.1:8080", session: str | None = None, token: str | None = None, *,
            timeout: float = 30, verify: Verify = True) -> Session:
    """Opens a session of the server; a new name opens a new one.

    address: "127.0.0.1:8080", or the page's address, whose ?session=NAME counts if `session` is None ("main" then).
    token: of --token (operator) or --view-token (may only look).
    timeout: [s] for each answer. verify: of https, True, the path of a CA's certificate, an SSLContext, or False.
    Raises ConnectionLost if there is no server or it refuses, Refused (-32001) if it wants (another) token.
    """
    return Session(_Address(address, session, token, verify), timeout)


class Session:
    """One connection. Several threads may use it. hello: what the server said first (versions, methods, limits)."""

    def __init__(self, address: _Address, timeout: float) -> None:
        self._address = address
        self.timeout = timeout
        self._changed = threading.Condition()
        self._next_id = 1
        self._listeners: dict[str, list[Callable[[dict[str, Json]], None]]] = {}
        self.reconnect()

    # -- the connection

    def reconnect(self, patience: float = 0) -> None:
        """Connects anew, to the same session with the same token. Frames, hands and jobs of before are gone.

        patience: [s] for how long to try again if there is no server, or it refuses: while one is started anew, or
        another takes the session over (the connection was lost with code 1012).
        """
        until = time.monotonic() + patience
        while True:
            try:
                return self._connect()
            except ConnectionLost:
                if time.monotonic() + RETRY_TIME > until:
                    raise
            time.sleep(RETRY_TIME)

    def _connect(self) -> None:
        if hasattr(self, "_socket"):
            self.close()
        self._socket = _WebSocket(self._address, self.timeout)
        self._lost: ConnectionLost | None = None
        self._answers: dict[int, dict[str, Json] | None] = {}
        self._waiting: list[tuple[tuple[str, ...], collections.deque[tuple[str, dict[str, Json]]]]] = []
        self._greeting: dict[str, Json] | None = None
        self._topology: Topology | None = None
        self._frame: Frame | None = None
        self._subscribed: dict[str, Json] | None = None
        threading.Thread(target=self._read, args=(self._socket,), name="clothlab", daemon=True).start()
        try:
            # Without a token any request is refused at once where one is needed; else the server would say nothing.
            token = self._address.token
            self.request(*(("ping",) if token is None else ("auth", {"token": token})))
            self.hello = self._wait(lambda: self._greeting, "the server's hello", self.timeout)
        except ClothlabError:
            self.close()
            raise

    def close(self) -> None:
        """Ends the connection; the session itself runs on."""
        with self._changed:
            self._lost = self._lost or ConnectionLost("this script closed the connection", 1000)
            self._changed.notify_all()
        self._socket.close()

    @property
    def connected(self) -> bool:
        return self._lost is None

    @property
    def version(self) -> str:
        """Of Clothlab on the server, as `clothlab --version` there says it."""
        return _member(self.hello, "version", str, "hello")

    @property
    def role(self) -> str:
        """"operator" or "viewer"."""
        return _member(self.hello, "role", str, "hello")

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _read(self, connection: _WebSocket) -> None:
        lost = ConnectionLost("the connection broke off", 1006)
        try:
            while True:
                kind, data = connection.receive()
                if kind == _WebSocket.BINARY:
                    self._take_binary(connection, data)
                else:
                    self._take_text(_message(data))
        except ConnectionLost as error:
            lost = error
        except Exception as error:  # whatever it is, nobody may wait for this thread any longer
            lost = ConnectionLost(f"the connection broke off: {error}", 1006)
        with self._changed:
            if connection is self._socket:
                self._lost = self._lost or lost
            self._changed.notify_all()
        connection.abandon()
        connection.stream.close()

    def _take_binary(self, connection: _WebSocket, data: bytes) -> None:
        if data[0] == 1:
            self._topology = Topology(data)
        elif data[0] == 2 and self._topology:
            frame = Frame(data, self._topology)
            with self._changed:
                self._frame = frame
                self._changed.notify_all()
            message = {"jsonrpc": "2.0", "method": "stream.ack", "params": {"frame": frame.sequence}}
            connection.send(json.dumps(message).encode())

    def _take_text(self, message: dict[str, Json]) -> None:
        with self._changed:
            if "method" in message:
                name, params = message["method"], message.get("params", {})
                if name == "hello":
                    self._greeting = params
                for names, queue in self._waiting:
                    if name in names:
                        queue.append((name, params))
            elif message.get("id") in self._answers:
                self._answers[message["id"]] = message
            self._changed.notify_all()
        for listener in self._listeners.get(message.get("method", ""), []):
            try:
                listener(message.get("params", {}))
            except Exception:  # a listener's mistake must not end the connection
                traceback.print_exc()

    def _wait(self, look: Callable[[], Any], what: str, timeout: float | None) -> Any:
        end = math.inf if timeout is None else time.monotonic() + timeout
        with self._changed:
            while (found := look()) is None:
                if self._lost:
                    raise ConnectionLost(str(self._lost), self._lost.code)
                left = end - time.monotonic()
                if left <= 0:
                    raise Timeout(f"waited {timeout} s for {what}")
                self._changed.wait(min(left, 1.0))  # never long: Ctrl-C counts between two waits on any system
            return found

    @contextlib.contextmanager
    def _hearing(self, *names: str) -> Iterator[collections.deque[tuple[str, dict[str, Json]]]]:
        """What is told under these names from now on."""
        heard: collections.deque[tuple[str, dict[str, Json]]] = collections.deque(maxlen=MOST_HEARD)
        entry = (names, heard)
        with self._changed:
            self._waiting.append(entry)
        try:
            yield heard
        finally:
            with self._changed:
                self._waiting = [other for other in self._waiting if other is not entry]

    # -- requests of any kind

    def request(self, method: str, params: Mapping[str, Json] | None = None, *, timeout: float | None = None) -> Any:
        """Calls any method of the protocol and returns its result; `hello` and the server's AsyncAPI document tell
        which there are. timeout [s]: None is that of connect(). Raises Refused, Timeout, ConnectionLost."""
        with self._changed:
            number = self._next_id
            self._next_id += 1
            self._answers[number] = None
        try:
            self._send({"id": number, "method": method, "params": dict(params or {})})
            message = self._wait(lambda: self._answers[number], f"the answer to {method}", timeout or self.timeout)
        finally:
            self._answers.pop(number, None)
        if "error" in message:
            raise Refused(message["error"])
        return message.get("result")

    def _ask(self, method: str, key: str, kind: type, params: Mapping[str, Json] | None = None) -> Any:
        """This member of a request's result."""
        return _member(self.request(method, params), key, kind, f"the answer to {method}")

    def notify(self, method: str, params: Mapping[str, Json] | None = None) -> None:
        """Sends without waiting for an answer; what is wrong with it comes as a `notice`, if at all."""
        self._send({"method": method, "params": dict(params or {})})

    def _send(self, message: dict[str, Json]) -> None:
        if self._lost:
            raise ConnectionLost(str(self._lost), self._lost.code)
        try:
            text = json.dumps({"jsonrpc": "2.0", **message}, allow_nan=False, default=_plain)
        except ValueError as error:
            raise ClothlabError(f"{message['method']}: its parameters hold a number that is not finite") from error
        try:
            self._socket.send(text.encode())
        except OSError as error:
            with self._changed:
                self._changed.wait_for(lambda: self._lost, 1)  # what the server said before it closed
            raise ConnectionLost(str(self._lost or error), self._lost.code if self._lost else 1006) from error

    def on(self, method: str, listener: Callable[[dict[str, Json]], None]) -> None:
        """Calls `listener` with each notification of this name ("sim.diverged", "scene.changed", "notice", ...), from
        the thread that reads: it must be quick, and make no request."""
        self._listeners.setdefault(method, []).append(listener)

    def wait(self, method: str, accept: Callable[[dict[str, Json]], bool] = lambda _: True,
             timeout: float | None = None) -> dict[str, Json]:
        """The next notification of this name from now on that `accept` takes."""
        end = time.monotonic() + (timeout or self.timeout)
        with self._hearing(method) as queue:
            while True:
                _, params = self._wait(lambda: queue.popleft() if queue else None, method, end - time.monotonic())
                if accept(params):
                    return params

    # -- the scene

    def get(self, pointer: str = "") -> Json:
        """The scene, or what is at this pointer in it. Raises KeyError where nothing is."""
        found = _at(self._ask("scene.get", "document", dict), pointer)
        if found is None:
            raise KeyError(f"{pointer}: the scene has nothing there")
        return found[0]

    def set(self, changes: Mapping[str, Json]) -> dict[str, Json]:
        """Changes {pointer: value, ...} as one patch: all of it or nothing. "/cloths/0/pins/-" adds to a list."""
        scene = self.get()
        return self.patch([{"op": "add" if _at(scene, pointer) is None else "replace", "path": pointer, "value": value}
                           for pointer, value in changes.items()])

    def __getitem__(self, pointer: str) -> Json:
        return self.get(pointer)

    def __setitem__(self, pointer: str, value: Json) -> None:
        self.set({pointer: value})

    def __delitem__(self, pointer: str) -> None:
        self.patch([{"op": "remove", "path": pointer}])

    @property
    def revision(self) -> int:
        return self._ask("scene.get", "revision", int)

    def patch(self, patch: Mapping[str, Json] | Sequence[Mapping[str, Json]],
              revision: int | None = None, keep_stable: bool = False) -> dict[str, Json]:
        """A dict is an RFC 7396 merge patch, a list an RFC 6902 patch. With `revision` it is refused (-32003) if the
        scene has another. keep_stable: the solver changes with it where the cloth would not hold, and the answer has
        it. Returns {"revision", "applies"}; applies "cloth" means that time began again at 0."""
        return self.request("scene.patch", {"patch": patch, **({} if revision is None else {"revision": revision}),
                                            **({"keep_stable": True} if keep_stable else {})})

    def load(self, scene: str | os.PathLike[str] | Mapping[str, Json]) -> dict[str, Json]:
        """Another scene from its beginning: a preset's name, the path of a .json file, or the document."""
        if isinstance(scene, os.PathLike) or (isinstance(scene, str) and scene.endswith(".json")):
            with open(scene, encoding="utf-8") as file:
                scene = json.load(file)
        return self.request("scene.load", {"preset": scene} if isinstance(scene, str) else {"scene": scene})

    def presets(self) -> list[str]:
        """Their names, for load()."""
        return self._ask("scene.presets", "presets", list)

    def fabrics(self) -> list[dict[str, str]]:
        """{"name", "feel", "source"} of each measured fabric, for a cloth's /material/fabric."""
        return self._ask("scene.presets", "fabrics", list)

    def upload_mesh(self, name: str, content: str | bytes | os.PathLike[str] | None = None) -> dict[str, Json]:
        """Gives the session a mesh that a cloth or a collider can name: {"mesh": {"file": name}}.

        content: of an .obj, .ply or glTF file, as text or bytes; or a path; None: `name` is the path, its last part the
        name. At most 8 MiB. Returns what is in it: {"vertices", "triangles", "box", ...}.
        """
        if content is None or isinstance(content, os.PathLike):
            with open(name if content is None else content, "rb") as file:
                name, content = os.path.basename(name), file.read()
        if isinstance(content, bytes):
            try:
                content = content.decode("utf-8")
            except UnicodeDecodeError:
                obj = base64.b64encode(content).decode()
                return self.request("mesh.upload", {"name": name, "obj": obj, "encoding": "base64"})
        return self.request("mesh.upload", {"name": name, "obj": content})

    # -- the simulation; all of these return {"playing", "time" [s], "step"}

    def play(self) -> dict[str, Json]:
        return self.request("sim.play")

    def pause(self) -> dict[str, Json]:
        return self.request("sim.pause")

    def step(self, steps: int = 1, timeout: float | None = None) -> dict[str, Json]:
        """Pauses, does so many steps, and returns when they are done. timeout [s]: None waits as long as it takes.
        Raises Refused (-32004) if the simulation blows up."""
        return self.request("sim.step", {"steps": steps}, timeout=timeout or math.inf)

    def reset(self) -> dict[str, Json]:
        """Back to the start at time 0, playing or pausing as before."""
        return self.request("sim.reset")

    def speed(self, factor: float) -> dict[str, Json]:
        """Simulated seconds a second."""
        return self.request("sim.speed", {"factor": factor})

    def status(self) -> dict[str, Json]:
        """The next `sim.status`, within a tenth of a second: playing, time, step, real_time_factor, energy [J],
        max_strain, max_speed [m/s], contacts, passes, stability {dt_limit [s], margin}, asleep, ..."""
        return self.wait("sim.status")

    def grab(self, vertex: int, target: Sequence[float], cloth: int = 0, hand: int = 0) -> Hand:
        """A hand, 0 to 9, takes this vertex of the cloth (as in frames) and pulls it to a place [m]."""
        self.request("grab.start", {"cloth": cloth, "vertex": vertex, "target": list(target), "hand": hand})
        return Hand(self, hand)

    # -- frames

    def frame(self, encoding: str = "f32", field: str | None = None) -> Frame:
        """The cloth now. encoding: "f32" or "q16" (a third of the bytes). field: "strain", "speed" or "contact"."""
        before = self._subscribed
        self._subscribe({"encoding": encoding, "rate": 120, **({"field": field} if field else {})})
        try:
            return self._wait(lambda: self._frame, "a frame", self.timeout)
        finally:
            if self.connected:
                self._subscribe(before)

    def frames(self, rate: float = 60, encoding: str = "f32", field: str | None = None,
               timeout: float | None = None) -> Iterator[Frame]:
        """Frames as they come, at most `rate` a second, always the newest; what was missed is skipped. While nothing
        moves none come: timeout [s] then raises Timeout. Break off whenever you like."""
        self._subscribe({"encoding": encoding, "rate": rate, **({"field": field} if field else {})})
        last: Frame | None = None
        try:
            while True:
                last = self._wait(lambda: None if self._frame is last else self._frame, "a frame", timeout)
                yield last
        finally:
            if self.connected:
                self._subscribe(None)

    def _subscribe(self, wish: dict[str, Json] | None) -> None:
        # Another form may be on its way until the answer, and only what comes after it counts.
        if self._subscribed is not None:
            self.request("stream.unsubscribe")
        self._subscribed, self._frame = None, None
        if wish is not None:
            self.request("stream.subscribe", wish)
            self._subscribed = wish

    # -- the lab: each waits for its result, as long as it takes; Ctrl-C cancels the job

    def chart(self, progress: Callable[[float, float], None] | None = None, **options: Json) -> dict[str, Json]:
        """Every method's cost and error on this scene. options: methods, iterations, time, budget [s], pause, fresh.
        Returns the `lab.result`: {"job", "state", "result", "stale", ...}. progress: called with (done, total)."""
        return self._measure("lab.chart", options, progress)

    def stability(self, progress: Callable[[float, float], None] | None = None, **options: Json) -> dict[str, Json]:
        """Where each method becomes unstable. options: methods, field (a pointer), from, to, columns, pause, fresh."""
        return self._measure("lab.stability", options, progress)

    def choose(self, tolerance: float, progress: Callable[[float, float], None] | None = None,
               **options: Json) -> dict[str, Json]:
        """The cheapest setting whose RMS position error over the cloth's size is at most `tolerance`."""
        return self._measure("lab.choose", {"tolerance": tolerance, **options}, progress)

    def simplify(self, progress: Callable[[float, float], None] | None = None, **options: Json) -> dict[str, Json]:
        """Which parts of the model this scene needs. options: tolerance, time, pause, fresh."""
        return self._measure("lab.simplify", options, progress)

    def export(self, job: int, format: str) -> str:
        """What a job has found, as a file's text: "svg", "csv" or "json"."""
        return self._ask("lab.export", "text", str, {"job": job, "format": format})

    def _measure(self, method: str, options: Mapping[str, Json],
                 progress: Callable[[float, float], None] | None) -> dict[str, Json]:
        with self._hearing("lab.progress", "lab.result") as queue:
            job = self._ask(method, "job", int, options)
            try:
                while True:
                    name, params = self._wait(lambda: queue.popleft() if queue else None, method, None)
                    if params.get("job") != job:
                        continue
                    if name == "lab.progress" and progress:
                        progress(_member(params, "done", (int, float), name),
                                 _member(params, "total", (int, float), name))
                    if name == "lab.result" and params.get("state") == "failed":
                        error = params["error"] if isinstance(params.get("error"), dict) else {}
                        text = f"{method} failed: {error.get('path', '')} {error.get('found', '')}"
                        raise Refused({"message": text, "data": error, "code": -32603})
                    if name == "lab.result" and params.get("state") in ("finished", "cancelled"):
                        return params
            except BaseException as error:
                if self.connected and not isinstance(error, Refused):
                    self.notify("lab.cancel", {"job": job})
                raise

    # -- pictures

    def picture(self, width: int = 1280, height: int = 720) -> bytes:
        """A PNG of the cloth now; width and height [pixels]."""
        return self._http("/api/snapshot.png", width=width, height=height)

    def mesh(self) -> str:
        """The cloth now as an .obj file."""
        return self._http("/api/mesh.obj").decode("utf-8", "replace")

    def html(self, height: int = 480) -> Page:
        """The live page of this session in a notebook's cell; as the function html()."""
        return Page(self._address.url("/"), height)

    def _http(self, path: str, **query: Json) -> bytes:
        request = urllib.request.Request(self._address.url(path, **query))
        if self._address.token is not None:
            request.add_unredirected_header("Authorization", "Bearer " + self._address.token)
        try:
            with urllib.request.urlopen(request, timeout=self.timeout, context=self._address.context) as answer:
                body = answer.read(MOST_ANSWER_BYTES + 1)
        except urllib.error.HTTPError as error:
            why = error.read(4096).decode("utf-8", "replace").strip()
            raise ConnectionLost(f"{path} ({error.code}): {why}", error.code) from None
        except (OSError, http.client.HTTPException, ValueError) as error:
            raise ConnectionLost(f"{path}: {error}") from error
        if len(body) > MOST_ANSWER_BYTES:
            raise ConnectionLost(f"{path}: an answer of more than {MOST_ANSWER_BYTES} bytes; ask for less")
        return body


def _message(data: bytes) -> dict[str, Json]:
    """A text message of JSON-RPC, in the form that all below relies on."""
    message = json.loads(data)
    if not isinstance(message, dict):
        raise ConnectionLost("the server sent a message that is no object; is it a Clothlab server?", 1002)
    if "method" in message and not (isinstance(message["method"], str)
                                    and isinstance(message.setdefault("params", {}), dict)):
        raise ConnectionLost("the server sent a notification without a name, or without named parameters", 1002)
    if "error" in message and not isinstance(message["error"], dict):
        message["error"] = {"message": str(message["error"])}
    return message


def _member(of: Json, key: str, kind: type | tuple[type, ...], what: str) -> Any:
    if isinstance(of, dict) and isinstance(of.get(key), kind):
        return of[key]
    raise ClothlabError(f"{what} has no {key!r}, or of another type; fetch the server's own client")


def _at(document: Json, pointer: str) -> tuple[Json] | None:
    """What is at this pointer, as a tuple of one; None where nothing is."""
    if pointer and not pointer.startswith("/"):
        raise ValueError(f"{pointer!r} is no JSON Pointer; one starts with /, like '/solver/dt'")
    for key in pointer.split("/")[1:]:
        key = key.replace("~1", "/").replace("~0", "~")
        try:
            document = document[int(key) if isinstance(document, list) else key]
        except (KeyError, IndexError, ValueError, TypeError):
            return None
    return (document,)


def _plain(value: Any) -> Json:
    """NumPy's numbers and arrays as JSON's."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise ClothlabError(f"{value!r} is no value of JSON: give numbers, text, lists and dicts")
