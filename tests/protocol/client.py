"""The Python client as a server serves it, against that server. Run by client_python.test.mjs, with NumPy at hand."""

import base64
import contextlib
import hashlib
import importlib.util
import io
import json
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
import urllib.request

PROGRAM = os.environ["CLOTHLAB"]
FOLDER = tempfile.TemporaryDirectory()


class Server:
    """`clothlab serve` with these options, until stop() or the end of a with block."""

    def __init__(self, *options):
        port = [] if "--port" in options else ["--port", "0"]
        environment = {key: value for key, value in os.environ.items() if not key.startswith("CLOTHLAB_")}
        self.process = subprocess.Popen([PROGRAM, "serve", *port, *options], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True, env=environment)
        self.address = re.match(r"listening on (\S+)/\n", self.process.stdout.readline()).group(1)
        self.port = self.address.rpartition(":")[2]

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(30)
        self.process.stdout.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


def served(server):
    """The module that this server serves."""
    path = pathlib.Path(FOLDER.name) / "clothlab.py"
    with urllib.request.urlopen(server.address + "/clothlab.py") as answer:
        path.write_bytes(answer.read())
    spec = importlib.util.spec_from_file_location("clothlab", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


server = Server("--max-sessions", "100")
clothlab = served(server)


def tearDownModule():
    server.stop()


class Connected(unittest.TestCase):
    """Each test has a client in a session of its own."""

    def setUp(self):
        self.cloth = clothlab.connect(server.address, session=self.id().rpartition(".")[2])
        self.addCleanup(self.cloth.close)


class Hostile:
    """Takes one connection, answers its handshake, or sends `head` in its place, and then sends these bytes. Its
    answers are these, the last one to all further requests."""

    def __init__(self, sends=b"", head=None, answers=({"result": {}},)):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.thread = threading.Thread(target=self.serve, args=(sends, head, list(answers)))
        self.thread.start()

    def serve(self, sends, head, answers):
        connection, _ = self.listener.accept()
        with connection, contextlib.suppress(OSError):
            request = b""
            while b"\r\n\r\n" not in request:
                request += connection.recv(4096)
            key = re.search(rb"(?i)sec-websocket-key: *(\S+)", request).group(1)
            proof = hashlib.sha1(key + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest()
            good = b"HTTP/1.1 101 x\r\nSec-WebSocket-Accept: " + base64.b64encode(proof) + b"\r\n\r\n"
            connection.sendall(good if head is None else head)
            connection.sendall(sends)
            while asked := connection.recv(6, socket.MSG_WAITALL):  # short messages: two bytes of head, the mask
                data, mask = connection.recv(asked[1] & 127, socket.MSG_WAITALL), asked[2:]
                text = bytes(byte ^ mask[i % 4] for i, byte in enumerate(data))
                if text.startswith(b"{"):
                    answer = answers.pop(0) if len(answers) > 1 else answers[0]
                    connection.sendall(said({"id": json.loads(text).get("id"), **answer}))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.thread.join(30)
        self.listener.close()


def said(value, opcode=1):
    """A message as a server frames it."""
    data = value if isinstance(value, bytes) else json.dumps(value).encode()
    return bytes([0x80 | opcode, 126]) + struct.pack("!H", len(data)) + data


HELLO = said({"method": "hello", "params": {"role": "operator"}})


class HostileServers(unittest.TestCase):
    def test_what_breaks_the_protocol_is_an_error_of_this_client_and_never_read_without_bound(self):
        frame_head = struct.pack("<BBHIIIdQ", 2, 0, 0, 1, 1, 10**9, 0, 0) + bytes(24)
        for what, given in {
            "headers without end": {"head": b"HTTP/1.1 101 x\r\n" + b"a: b\r\n" * 20_000},
            "a header line without end": {"head": b"HTTP/1.1 101 x\r\n" + b"a" * 100_000},
            "a refusal of negative length": {"head": b"HTTP/1.1 400 x\r\ncontent-length: -1\r\n\r\n"},
            "a message of 2^62 bytes": {"sends": b"\x81\x7f" + struct.pack("!Q", 1 << 62) + b"x" * 1000},
            "pieces without end": {"sends": (b"\x01\x7f" + struct.pack("!Q", 1 << 25) + bytes(1 << 25)) * 3},
            "a long ping": {"sends": b"\x89\x7f" + struct.pack("!Q", 1 << 40)},
            "a list": {"sends": said([1])},
            "a text that is no JSON": {"sends": said(b"{")},
            "a name that is none": {"sends": said({"method": 7})},
            "parameters without names": {"sends": said({"method": "hello", "params": [1]})},
            "an error that is a text": {"answers": [{"error": "no"}]},
            "an error with a list of facts": {"answers": [{"error": {"data": [1]}}]},
            "an empty binary message": {"sends": said(b"", 2)},
            "a frame of fewer vertices than it says": {"sends": HELLO + said(
                struct.pack("<BBHIIIdQ", 1, 0, 0, 1, 0, 0, 0, 0) + bytes(24) + bytes(8), 2) + said(frame_head, 2)},
        }.items():
            with self.subTest(what), Hostile(**given) as hostile, self.assertRaises(clothlab.ClothlabError):
                with clothlab.connect(hostile.address, timeout=20) as cloth:
                    cloth._wait(lambda: None, "the end", 20)

    def test_answers_that_lack_what_they_should_have_say_so(self):
        for ask, answer in (
            (lambda cloth: cloth.get(), None),
            (lambda cloth: cloth.revision, {"revision": "7"}),
            (lambda cloth: cloth.presets(), []),
            (lambda cloth: cloth.export(1, "csv"), {}),
            (lambda cloth: cloth.chart(), {"job": None}),
        ):
            with Hostile(HELLO, answers=[{"result": {}}, {"result": answer}]) as hostile, clothlab.connect(hostile.address, timeout=20) as cloth:
                with self.assertRaisesRegex(clothlab.ClothlabError, "the answer to .* has no '"):
                    ask(cloth)


class Scene(Connected):
    def test_keys_are_read_set_together_and_removed(self):
        cloth = self.cloth
        self.assertEqual(cloth["/gravity"], [0, -9.8, 0])
        self.assertEqual(cloth.get()["name"], "seed")
        cloth["/gravity/1"] = -1.6
        revision = cloth.revision
        self.assertEqual(cloth.set({"/air_drag": 0.5, "/cloths/0/pins/-": {"at": "vertex:12"}})["revision"], revision + 1)
        self.assertEqual((cloth["/gravity/1"], cloth["/air_drag"]), (-1.6, 0.5))
        pins = cloth["/cloths/0/pins"]
        del cloth[f"/cloths/0/pins/{len(pins) - 1}"]
        self.assertEqual(cloth["/cloths/0/pins"], pins[:-1])
        with self.assertRaisesRegex(KeyError, "/colliders/7"):
            cloth["/colliders/7"]
        with self.assertRaisesRegex(ValueError, "starts with /"):
            cloth["gravity"]

    def test_a_wrong_value_says_where_what_and_what_is_allowed(self):
        before = self.cloth.get()
        with self.assertRaises(clothlab.Refused) as caught:
            self.cloth.set({"/air_drag": 0.5, "/solver/dt": -1})
        self.assertEqual((caught.exception.code, caught.exception.path, caught.exception.found),
                         (-32602, "/solver/dt", "-1"))
        self.assertIn("1e-09", caught.exception.allowed)
        self.assertEqual(self.cloth.get(), before)
        with self.assertRaises(clothlab.Refused) as caught:
            self.cloth.patch({"gravity": [0, 0, 0]}, revision=self.cloth.revision + 5)
        self.assertEqual((caught.exception.code, caught.exception.data["revision"]), (-32003, self.cloth.revision))
        with self.assertRaisesRegex(clothlab.ClothlabError, "not finite"):
            self.cloth["/gravity/1"] = float("nan")
        with self.assertRaisesRegex(clothlab.ClothlabError, "no value of JSON"):
            self.cloth["/name"] = object()

    def test_a_patch_may_ask_that_the_cloth_stays_stable(self):
        stiff = [{"op": "replace", "path": "/cloths/0/material/structural", "value": 1e5}]
        self.assertGreater(self.cloth.patch(stiff, keep_stable=True)["solver"]["dt"], 0)

    def test_presets_documents_and_files_are_loaded(self):
        self.assertIn("flag", self.cloth.presets())
        self.assertIn("cotton", [fabric["name"] for fabric in self.cloth.fabrics()])
        self.cloth.load("flag")
        self.assertEqual(self.cloth["/name"], "flag")
        document = {**self.cloth.get(), "name": "mine"}
        self.cloth.load(document)
        self.assertEqual(self.cloth["/name"], "mine")
        path = pathlib.Path(FOLDER.name) / "scene.json"
        path.write_text('{"version": 1, "name": "filed", "cloths": [{"mesh": {"grid": {"columns": 3, "rows": 3}}}]}')
        for given in (path, str(path)):
            self.cloth.load(given)
            self.assertEqual(self.cloth["/name"], "filed")
        with self.assertRaisesRegex(clothlab.Refused, "nosuch"):
            self.cloth.load("nosuch")

    def test_a_mesh_goes_up_as_text_bytes_and_path(self):
        text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        path = pathlib.Path(FOLDER.name) / "a.obj"
        path.write_text(text)
        header = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + b"".join(
            b"property float %c\n" % axis for axis in b"xyz")
        header += b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        import numpy as np
        binary = header + np.array([0, 0, 0, 1, 0, 0, 0, 1, 0.3], "<f4").tobytes() + b"\3" + np.arange(
            3, dtype="<i4").tobytes()
        for given in ((str(path),), ("b.obj", text), ("c.obj", text.encode()), ("d.obj", path), ("e.ply", binary)):
            answer = self.cloth.upload_mesh(*given)
            self.assertEqual((answer["vertices"], answer["triangles"]), (3, 1), given)
        self.assertEqual(answer["name"], "e.ply")
        with self.assertRaisesRegex(clothlab.Refused, "line 1"):
            self.cloth.upload_mesh("bad.obj", "v 0 0\n")

    def test_any_method_can_be_called_and_an_unknown_one_is_refused(self):
        self.assertEqual(self.cloth.request("ping", {"t": [1, "ä"]}), {"t": [1, "ä"]})
        with self.assertRaises(clothlab.Refused) as caught:
            self.cloth.request("no.such")
        self.assertEqual(caught.exception.code, -32601)
        self.assertIn("scene.get", caught.exception.allowed)
        self.cloth.notify("ping")

    def test_notifications_reach_listeners_and_who_waits(self):
        heard = []
        self.cloth.on("scene.changed", lambda change: heard.append(change["patch"]))
        self.cloth.on("scene.changed", lambda change: 1 / 0)  # told on stderr, and nothing ends
        with contextlib.redirect_stderr(io.StringIO()) as errors:
            other = clothlab.connect(server.address, session=self.id().rpartition(".")[2])
            threading.Timer(0.2, lambda: other.patch({"air_drag": 0.25})).start()
            change = self.cloth.wait("scene.changed", lambda change: change["patch"] == {"air_drag": 0.25})
            with self.assertRaises(clothlab.Timeout):
                self.cloth.wait("scene.changed", timeout=0.1)
        self.assertIn("ZeroDivisionError", errors.getvalue())
        self.assertEqual(change["by"], other.hello["client"])
        self.assertEqual(heard, [{"air_drag": 0.25}])
        other.close()
        self.assertTrue(self.cloth.connected)


class Simulation(Connected):
    def test_a_frame_is_that_of_now_in_both_encodings(self):
        cloth = self.cloth
        cloth.pause()
        cloth.reset()
        for steps in (100, 57):
            moment = cloth.step(steps)
            exact = cloth.frame()
            self.assertEqual((exact.step, exact.time), (moment["step"], moment["time"]))
        self.assertEqual(exact.step, 157)
        self.assertEqual((exact.positions.shape, exact.normals.shape, exact.triangles.shape),
                         ((625, 3), (625, 3), (1152, 3)))
        self.assertEqual(exact.positions.dtype, "float32")
        self.assertEqual(exact.topology.cloths, [slice(0, 625)])
        self.assertEqual(exact.topology.texture.shape, (625, 2))
        self.assertIsNone(exact.field)
        packed = cloth.frame("q16", field="speed")
        self.assertEqual((packed.step, packed.encoding), (157, "q16"))
        extent = (exact.positions.max(0) - exact.positions.min(0)).max()
        self.assertLess(abs(packed.positions - exact.positions).max(), extent / 65535)
        self.assertGreater((packed.normals * exact.normals).sum(1).min(), 0.9998)  # within a degree
        speed = cloth.status()["max_speed"]
        self.assertLess(abs(packed.field.max() - speed), 0.02 * speed)
        # The .obj file says the same.
        vertices = [line.split()[1:] for line in cloth.mesh().splitlines() if line.startswith("v ")]
        import numpy as np
        self.assertLess(abs(np.array(vertices, float) - exact.positions).max(), 1e-5)

    def test_frames_come_at_the_rate_asked_for_and_stop_with_the_loop(self):
        times, came = [], []
        for frame in self.cloth.frames(rate=30, encoding="q16", timeout=30):
            times.append(frame.time)
            came.append(time.monotonic())
            if len(times) == 20:
                break
        self.assertEqual(times, sorted(times))
        self.assertGreater(came[-1] - came[5], 10 / 30)  # 14 intervals of a 30th, the first ones in flight
        one = next(self.cloth.frames(encoding="f32"))
        self.assertEqual(one.encoding, "f32")
        self.cloth.pause()
        with self.assertRaises(clothlab.Timeout):
            for _ in self.cloth.frames(timeout=0.5):
                pass

    def test_a_slow_script_sees_the_newest_frame(self):
        frames = self.cloth.frames(rate=60)
        first = next(frames)
        time.sleep(1)
        before = self.cloth.status()["step"]
        second = next(frames)
        # One that had waited during the sleep would be as old as the first.
        self.assertGreater(second.step, (first.step + before) / 2)
        frames.close()

    def test_controls_and_hands(self):
        cloth = self.cloth
        self.assertFalse(cloth.pause()["playing"])
        self.assertEqual(cloth.reset()["step"], 0)
        self.assertEqual(cloth.speed(2), {"factor": 2})
        self.assertTrue(cloth.play()["playing"])
        with cloth.grab(300, [0, 1.2, 0.5]) as hand:
            hand.move([0, 1.3, 0.5])
            self.assertEqual([held["vertex"] for held in cloth.status()["hands"]], [300])
        cloth.wait("sim.status", lambda status: not status.get("hands") and status["time"] > 0)
        with self.assertRaises(clothlab.Refused) as caught:
            cloth.grab(100000, [0, 0, 0])
        self.assertEqual(caught.exception.path, "/vertex")

    def test_a_blow_up_is_an_error(self):
        self.cloth.load("blowup")
        with self.assertRaises(clothlab.Refused) as caught:
            self.cloth.step(100000)
        self.assertEqual(caught.exception.code, -32004)
        self.assertTrue(self.cloth.frame().diverged)

    def test_the_lab_tells_its_progress_and_its_result(self):
        progress = []
        self.cloth.load({"version": 1, "cloths": [{"mesh": {"grid": {"columns": 5, "rows": 5}},
                                                   "pins": [{"at": "edge:row:0"}]}]})
        told = self.cloth.choose(0.1, lambda done, total: progress.append((done, total)), time=0.05,
                                 methods=["symplectic_euler"])
        self.assertEqual(told["state"], "finished")
        self.assertEqual(told["result"]["chosen"]["method"], "symplectic_euler")
        self.assertTrue(progress and all(done <= total for done, total in progress))
        self.assertIn("symplectic_euler", self.cloth.export(told["job"], "csv"))
        with self.assertRaises(clothlab.Refused) as caught:
            self.cloth.chart(methods=["nosuch"])
        self.assertIn("nosuch", caught.exception.found)

    def test_an_interrupted_measurement_is_cancelled(self):
        def interrupt(done, total):
            raise KeyboardInterrupt
        with self.assertRaises(KeyboardInterrupt):
            self.cloth.chart(interrupt, budget=600)
        ended = self.cloth.wait("lab.result", lambda result: result["state"] != "running")
        self.assertEqual(ended["state"], "cancelled")


class Connection(unittest.TestCase):
    def test_the_address_may_be_the_pages_own(self):
        with clothlab.connect(server.address + "/?session=fromurl") as cloth:
            self.assertIn("session=fromurl", cloth.html()._repr_html_())
            self.assertEqual((cloth.role, cloth.hello["session"]), ("operator", "fromurl"))
        for wrong in ("ftp://host", "http://", "//"):
            with self.assertRaisesRegex(ValueError, "no address of a server"):
                clothlab.connect(wrong)

    def test_no_server_and_a_refusal_say_so(self):
        with self.assertRaisesRegex(clothlab.ConnectionLost, "no server answers at 127.0.0.1:1"):
            clothlab.connect("127.0.0.1:1", timeout=5)
        with self.assertRaisesRegex(clothlab.ConnectionLost, r"\(400\): .*session") as caught:
            clothlab.connect(server.address, session="no name!")
        self.assertEqual(caught.exception.code, 400)

    def test_a_closed_connection_says_so_and_can_be_made_anew(self):
        cloth = clothlab.connect(server.address, session="again")
        cloth["/air_drag"] = 0.75
        cloth.close()
        cloth.close()
        self.assertFalse(cloth.connected)
        for call in (cloth.get, cloth.frame, cloth.status, lambda: next(cloth.frames())):
            with self.assertRaisesRegex(clothlab.ConnectionLost, "this script closed"):
                call()
        cloth.reconnect()
        self.assertEqual(cloth["/air_drag"], 0.75)
        self.assertEqual(cloth.frame().vertices, 625)
        cloth.close()

    def test_the_end_of_a_server_ends_what_waits_and_another_one_is_found(self):
        passing = Server()
        cloth = clothlab.connect(passing.address)
        threading.Timer(0.3, passing.stop).start()
        with self.assertRaises(clothlab.ConnectionLost) as caught:
            cloth.wait("no.such", timeout=30)
        self.assertEqual(caught.exception.code, 1001)
        with self.assertRaises(clothlab.ConnectionLost):
            cloth.reconnect()
        passing.process.wait(30)
        another = []
        later = threading.Timer(1, lambda: another.append(Server("--port", passing.port)))
        later.start()
        cloth.reconnect(patience=60)
        later.join()
        with another[0]:
            self.assertEqual(cloth["/name"], "seed")
            cloth.close()

    def test_a_message_that_is_too_long_loses_the_connection_with_the_reason(self):
        cloth = clothlab.connect(server.address)
        with self.assertRaises(clothlab.ConnectionLost) as caught:
            cloth.request("ping", {"t": "x" * 70000})
        self.assertEqual(caught.exception.code, 1009)

    def test_several_threads_share_a_connection(self):
        with clothlab.connect(server.address, session="threads") as cloth:
            wrong = []

            def ask(number):
                for i in range(50):
                    if cloth.request("ping", {"t": [number, i]}) != {"t": [number, i]}:
                        wrong.append((number, i))
            threads = [threading.Thread(target=ask, args=(number,)) for number in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(wrong, [])

    def test_a_script_that_only_waits_answers_the_servers_pings(self):
        with Server("--idle-timeout", "2") as impatient, clothlab.connect(impatient.address) as cloth:
            time.sleep(6)
            self.assertEqual(cloth.request("ping"), {"t": None})

    def test_tokens_make_operators_and_viewers(self):
        with Server("--token", "secret", "--view-token", "public") as guarded:
            with self.assertRaisesRegex(clothlab.Refused, "requires a token") as caught:
                clothlab.connect(guarded.address)
            self.assertEqual(caught.exception.code, -32001)
            with self.assertRaisesRegex(clothlab.Refused, "not valid"):
                clothlab.connect(guarded.address, token="wrong")
            with clothlab.connect(guarded.address, token="secret") as operator, \
                    clothlab.connect(guarded.address, token="public") as viewer:
                self.assertEqual((operator.role, viewer.role), ("operator", "viewer"))
                self.assertEqual(operator.version, operator.hello["version"])
                self.assertRegex(operator.version, r"^\d+\.\d+\.\d+$")
                self.assertEqual(operator.patch({"air_drag": 0.5})["applies"], "uniform")
                self.assertEqual(viewer["/air_drag"], 0.5)
                self.assertEqual(viewer.frame().positions.shape, (625, 3))
                self.assertTrue(viewer.picture(64, 64).startswith(b"\x89PNG"))
                for change in (viewer.play, lambda: viewer.patch({}), lambda: viewer.choose(0.1)):
                    with self.assertRaises(clothlab.Refused) as caught:
                        change()
                    self.assertEqual(caught.exception.code, -32001)
                self.assertNotIn("secret", operator.html()._repr_html_())

    def test_https_is_checked_unless_told_otherwise(self):
        certificate = pathlib.Path(FOLDER.name) / "cert.pem"
        key = pathlib.Path(FOLDER.name) / "key.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost",
                        "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", certificate],
                       check=True, capture_output=True)
        with Server("--tls-cert", str(certificate), "--tls-key", str(key)) as safe:
            self.assertTrue(safe.address.startswith("https"))
            with self.assertRaisesRegex(clothlab.ConnectionLost, "certificate"):
                clothlab.connect(safe.address)
            for verify in (str(certificate), False):
                with clothlab.connect(safe.address, verify=verify) as cloth:
                    self.assertEqual(cloth.frame().vertices, 625)
                    self.assertTrue(cloth.picture(64, 64).startswith(b"\x89PNG"))


class Arrays(unittest.TestCase):
    def test_without_numpy_all_but_arrays_work(self):
        with clothlab.connect(server.address, session="plain") as cloth:
            frame = cloth.frame()
        hidden, sys.modules["numpy"] = sys.modules.get("numpy"), None
        try:
            self.assertEqual(len(frame.payload), 24 * frame.vertices)
            with self.assertRaisesRegex(clothlab.ClothlabError, "python3-numpy"):
                frame.positions
        finally:
            sys.modules.pop("numpy")
            if hidden:
                sys.modules["numpy"] = hidden

    def test_numpys_numbers_and_arrays_are_values(self):
        import numpy as np
        with clothlab.connect(server.address, session="numbers") as cloth:
            cloth["/gravity"] = np.array([0, -2.5, 0])
            cloth["/air_drag"] = np.float32(0.5)
            self.assertEqual((cloth["/gravity"], cloth["/air_drag"]), ([0, -2.5, 0], 0.5))


if __name__ == "__main__":
    unittest.main(verbosity=2)
