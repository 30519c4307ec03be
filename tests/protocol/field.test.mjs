// stream.subscribe with a field: a number at each vertex, after all vertices.
import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { decode } from "./decode.mjs";
import { Client, Server } from "./harness.mjs";

let server, client;
before(async () => (server = await Server.start()));
after(() => server.stop());
beforeEach(async () => {
  client = await Client.connect(server);
  await client.notification("scene");
  await client.request("scene.load", { preset: "seed" });
});
afterEach(() => client.close());

const names = ["strain", "speed", "contact"];
const subscribe = (params) => client.request("stream.subscribe", params);
/// Stops the session after `steps` from the start.
async function stopAt(steps) {
  await client.request("sim.pause");
  await client.request("sim.reset");
  await client.request("sim.step", { steps });
}

test("hello lists the fields, and subscribe answers the one that was agreed, or none", async () => {
  const other = await Client.connect(server);
  assert.deepEqual((await other.notification("hello")).fields, names);
  await other.close();
  for (const field of names)
    assert.deepEqual(await subscribe({ field }), { encoding: "q16", rate: 60, in_flight: 2, field });
  for (const params of [{}, { field: "none" }])
    assert.deepEqual(await subscribe(params), { encoding: "q16", rate: 60, in_flight: 2 });
});

test("a field that there is not is refused with what was found, what is allowed and the nearest name", async () => {
  const { code, data } = await client.refusal("stream.subscribe", { field: "strian" });
  assert.equal(code, -32602);
  assert.deepEqual(data, {
    path: "/field",
    found: '"strian"',
    allowed: 'one of "none", "strain", "speed", "contact"; did you mean "strain"?',
  });
  const { data: far } = await client.refusal("stream.subscribe", { field: "temperature" });
  assert.equal(far.allowed, 'one of "none", "strain", "speed", "contact"');
  for (const field of [1, null, true, ["speed"]])
    assert.equal((await client.refusal("stream.subscribe", { field })).data.path, "/field");
});

test("all frames after the answer have the field that it names, in both encodings, paused or not", async () => {
  await stopAt(300);
  for (const encoding of ["q16", "f32"])
    for (const field of [...names, "none"]) {
      const next = client.nextFrame();
      await subscribe({ encoding, field });
      const frame = await next;
      assert.equal(frame.encoding, encoding === "q16" ? 1 : 0);
      assert.equal(frame.step, 300);
      if (field === "none") {
        assert.equal(frame.range, 0);
        assert.equal(frame.field, undefined);
      } else {
        assert.equal(frame.field.length, 625);
        assert.ok(frame.range > 0);
      }
    }
});

test("no frame after an answer has the field of before, however often it changes", async () => {
  await client.request("sim.play");
  for (let i = 0; i < 12; ++i) {
    const field = [...names, "none"][(5 * i) % 4];
    await subscribe({ field, rate: 120, in_flight: 8 });
    const from = client.frames.length;
    await client.until(
      () => client.frames.slice(from + 2),
      () => true,
      "3 frames",
    );
    for (const frame of client.frames.slice(from)) assert.equal(frame.range > 0, field !== "none", field);
  }
});

test("a frame that is there already comes after the answer, too, though other answers wait before it", async () => {
  await stopAt(300);
  // Somebody else's subscription keeps a frame of each field there.
  const others = await Promise.all(names.map(() => Client.connect(server)));
  await Promise.all(others.map((other, i) => other.request("stream.subscribe", { field: names[i] })));
  await Promise.all(others.map((other) => other.frame(({ step, range }) => step === 300 && range > 0)));
  let agreed, early;
  client.socket.prependListener("message", (data, isBinary) => {
    if (!isBinary) agreed ||= JSON.parse(data).result?.field !== undefined;
    else if (!agreed && decode(data, client.topologies.at(-1)).range > 0) early = true;
  });
  for (let round = 0; round < 20; ++round)
    for (const field of names) {
      await subscribe({});
      [agreed, early] = [false, false];
      const next = client.nextFrame(({ range }) => range > 0);
      // In one packet, so that all answers wait when the first one is sent.
      client.socket._socket.cork();
      const answers = [...Array(8).keys()].map((t) => client.request("ping", { t }));
      answers.push(subscribe({ field }));
      client.socket._socket.uncork();
      await Promise.all(answers);
      await next;
      assert.equal(early, false, `${field} in round ${round}`);
    }
  await Promise.all(others.map((other) => other.close()));
});

test("the field's range holds the largest value that sim.status tells, and the bytes reach it", async () => {
  // A range still holds what was larger a moment before. So no field is watched between the start and step 600.
  await client.request("sim.pause");
  await client.request("sim.reset");
  for (const field of names) {
    const next = client.nextFrame((frame) => frame.step === 0);
    await subscribe({ field });
    await next;
  }
  await subscribe({ field: "none" });
  await client.request("sim.step", { steps: 600 });
  const status = await client.nextNotification("sim.status", ({ step }) => step === 600);
  const told = { strain: status.max_strain, speed: status.max_speed, contact: 1 };
  for (const field of names) {
    const next = client.nextFrame((frame) => frame.step === 600); // none that was under way before
    await subscribe({ field });
    const { range, field: values } = await next;
    const largest = Math.max(...values);
    assert.ok(range >= told[field] * (1 - 1e-6) && range <= 1.25 * told[field], `${field}: ${range}, ${told[field]}`);
    assert.ok(Math.abs(largest - told[field]) <= range / 255, `${field}: ${largest}, ${told[field]}`);
  }
  const contact = client.frames.at(-1).field;
  assert.ok(contact.every((value) => value === 0 || value === 1));
  assert.equal(contact.filter((value) => value === 1).length, status.contacts);
});

test("who asks for no field gets the same bytes, whatever others of the session ask for", async () => {
  await stopAt(300);
  const first = client.nextFrame();
  await subscribe({});
  const alone = await first;
  const other = await Client.connect(server);
  await other.request("stream.subscribe", { field: "speed" });
  const theirs = await other.frame();
  await client.request("scene.patch", { patch: { name: "another" } });
  await client.statuses(5); // a wait for a frame that need not come would keep the process for all its patience
  const beside = client.frames.at(-1);
  const { sequence: _, receivedAt: __, ...before } = alone;
  const { sequence: ___, receivedAt: ____, ...now } = beside;
  assert.deepEqual(now, before);
  assert.equal(now.payloadBytes, 8 * 625);
  assert.equal(theirs.payloadBytes, 9 * 625);
  assert.deepEqual(theirs.positions, now.positions);
  await other.close();
});

test("a viewer who changes the field without acknowledging goes on where it does", async () => {
  client.acknowledge = false;
  await client.request("sim.play");
  await subscribe({ in_flight: 2 });
  await client.until(
    () => client.frames.slice(1),
    () => true,
    "2 frames",
  );
  await subscribe({ in_flight: 2, field: "speed" });
  await client.statuses(3);
  assert.equal(client.frames.length, 2);
  client.acknowledge = true;
  client.notify("stream.ack", { frame: client.frames[1].sequence });
  await client.frame((frame) => frame.range > 0);
  await client.until(
    () => client.frames.slice(6),
    () => true,
    "more frames",
  );
});
