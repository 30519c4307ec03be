// Why a handshake was refused, which a browser does not tell the page.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { load } from "./module.mjs";

let refusalOf;
before(async () => {
  ({ refusalOf } = await load("link/refusal"));
});

test("the server's own reason is told, nothing of another answer, and nothing where no server answers", async (t) => {
  const why = "the server has as many sessions as it may; see --max-sessions";
  const [text, page] = ["text/plain; charset=utf-8", "text/html"];
  const asked = [];
  for (const [status, type, body, told] of [
    [503, text, `${why}\n`, why],
    [403, text, "pages of this origin may not connect", "pages of this origin may not connect"],
    [400, text, "no such name", "no such name"],
    [426, text, "connect with a WebSocket", ""],
    [503, page, "<h1>503</h1>", ""],
    [0, text, "", ""],
  ]) {
    t.mock.method(globalThis, "fetch", async (path) => {
      asked.push(path);
      if (status === 0) throw new TypeError("fetch failed");
      return new Response(body, { status, headers: { "content-type": type } });
    });
    assert.equal(await refusalOf("my session"), told);
  }
  assert.deepEqual([...new Set(asked)], ["/ws?session=my%20session"]);
});
