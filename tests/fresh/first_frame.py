"""Waits for the page and a frame from the server at the given URL, with the client that this server serves. Uses only
what the program's build has installed: Python without NumPy."""

import sys
import tempfile
import urllib.request

url = sys.argv[1]
sys.path.insert(0, tempfile.mkdtemp())
with urllib.request.urlopen(url.rstrip("/") + "/clothlab.py") as answer, open(sys.path[0] + "/clothlab.py", "wb") as file:
    file.write(answer.read())
import clothlab  # noqa: E402

with urllib.request.urlopen(url) as answer:
    page = answer.read().decode()
    assert "app.js" in page, page

with clothlab.connect(url, timeout=60) as cloth:
    frame = cloth.frame()
    print(f"a frame of {frame.vertices} vertices at {frame.time} s")
