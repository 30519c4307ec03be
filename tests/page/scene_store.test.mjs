// Edits on their way to the server: few messages, always the last value.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { load } from "./module.mjs";

globalThis.window = globalThis; // the page's timers are methods of window
const { SceneStore } = await load("link/scene_store");

const path = "/solver/dt";
const replace = (value, at = path) => [{ op: "replace", path: at, value }];
const wait = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

let store, sent, answer, fetched, changes, rejected;
beforeEach(() => {
  sent = [];
  changes = [];
  fetched = 0;
  rejected = null;
  answer = (patch) => Promise.resolve({ revision: store.revision + 1, applies: "uniform", patch });
  store = new SceneStore({
    send: (patch) => {
      sent.push(structuredClone(patch));
      return answer(patch);
    },
    fetch: async () => void ++fetched,
    changed: (document, whole) => changes.push({ document, whole }),
    applied: () => undefined,
    rejected: (error) => (rejected = error),
  });
  store.replace({ solver: { dt: 0.001, method: "verlet" }, cloths: [] }, 1);
});

test("of edits to one place in quick succession few are sent, and the last value is", async () => {
  for (let i = 1; i <= 40; ++i) {
    store.edit(replace(i));
    await wait(5);
  }
  await wait(150);
  assert.ok(sent.length < 20, `${sent.length} messages for 40 edits`);
  assert.deepEqual(sent.at(-1), replace(40));
  assert.equal(store.document.solver.dt, 40);
});

test("an edit of a whole drops those below it that wait, and a control there is busy until it is answered", async () => {
  let done;
  answer = () => new Promise((resolve) => (done = resolve));
  store.edit(replace(2));
  store.edit(replace({ dt: 3, method: "rk4" }, "/solver"));
  assert.ok(store.busy("/solver/dt") && store.busy("/solver") && !store.busy("/cloths"));
  await wait(60);
  assert.deepEqual(sent, [replace({ dt: 3, method: "rk4" }, "/solver")]);
  assert.ok(store.busy("/solver/method"));
  done({});
  await wait(5);
  assert.equal(store.busy("/solver/method"), false);
});

test("a patch of plain values is applied here; one that may bring defaults, or comes late, is fetched whole", () => {
  store.patched(2, { solver: { dt: 0.5 } });
  assert.deepEqual([store.document.solver.dt, fetched, changes.at(-1).whole], [0.5, 0, false]);
  store.patched(2, { solver: { dt: 0.7 } }); // the same revision a second time
  assert.equal(store.document.solver.dt, 0.5);
  store.patched(3, [{ op: "add", path: "/cloths/0", value: {} }]);
  store.patched(9, { solver: { dt: 1 } });
  assert.deepEqual([store.document.solver.dt, fetched], [0.5, 2]);
  store.patched(3, { wind: { velocity: [1, 0, 0] } }); // where there was none: its other numbers are the server's
  store.patched(3, { solver: { iterations: 4 } });
  assert.deepEqual([store.document.wind, store.document.solver.iterations, fetched], [undefined, undefined, 4]);
});

test("a refusal is reported, and the next edit is sent", async () => {
  answer = () => Promise.reject(new Error("no"));
  store.edit(replace(-1));
  await wait(80);
  assert.equal(rejected.message, "no");
  answer = () => Promise.resolve({ revision: 2 });
  store.edit(replace(0.002));
  await wait(80);
  assert.equal(store.document.solver.dt, 0.002);
});
