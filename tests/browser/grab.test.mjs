// Pulling at the cloth by real mouse, finger and keys, at a desktop's and a phone's size.
import assert from "node:assert/strict";
import { hanging } from "../protocol/hanging.mjs";
import { some } from "../thorough.mjs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { cameraPlace, complaints, distance, handsOf, hint, near, placeOf, seen, still } from "./hands.mjs";

const here = withServer();
const { both } = here;

// A sheet that hangs by three vertices of its upper edge.
const columns = 13;
const sheet = hanging(columns, 0.8, ["corner:0,0", "corner:6,0", "corner:12,0"]);
const vertex = 8 * columns + 6;
const sizes = [
  [1440, 900],
  [390, 844],
];

async function hang(session, width, height) {
  const opened = await both(session, { width, height });
  await opened.client.request("scene.load", { scene: sheet });
  await opened.viewer.until(() => window.clothlab.document?.name === "hanging" && window.clothlab.simTime > 0.5);
  await opened.client.request("stream.subscribe", { encoding: "f32", rate: 30 });
  await still(opened.viewer, vertex);
  return { ...opened, width, height };
}

browserTest(
  "the mouse pulls the cloth on a desktop's and a phone's window: the camera stays, the cloth comes",
  async () => {
    for (const [width, height] of some(sizes)) {
      const { viewer, client } = await hang(`mouse-${width}`, width, height);
      const { mouse } = viewer.page;
      const from = await seen(viewer, vertex);
      const camera = await cameraPlace(viewer);
      await mouse.move(from.x, from.y);
      await mouse.down();
      const { hands } = await handsOf(client, (all) => all.length === 1);
      assert.ok(Math.abs(hands[0].vertex - vertex) <= columns + 1, `it holds ${hands[0].vertex}, not ${vertex}`);
      const held = hands[0].vertex;
      const goal = { x: from.x + 0.12 * width, y: from.y - 60 };
      await mouse.move(goal.x, goal.y, { steps: 8 });
      await near(viewer, held, goal, "the vertex follows the mouse");
      assert.equal(await viewer.page.locator(".hands .mine line").count(), 1);
      assert.match(await hint(viewer).innerText(), /P pins it here/);
      await viewer.page.screenshot({ path: `${screenshots}grab-${width}.png` });
      assert.ok(distance(camera, await cameraPlace(viewer)) < 0.02, "the camera stayed");
      await mouse.up(); // now it may follow the cloth, which swings
      await handsOf(client, (all) => all.length === 0);
      await near(viewer, held, from, "it falls back");
      assert.equal(await hint(viewer).isVisible(), false);
      assert.deepEqual(complaints(viewer), []);
      await client.close();
      await viewer.page.close();
    }
  },
);

browserTest("a press beside the cloth orbits, and with Alt one on the cloth does, too", async () => {
  const { viewer, client } = await hang("beside", 1440, 900);
  const { mouse, keyboard } = viewer.page;
  const drag = async (x, y) => {
    const before = await cameraPlace(viewer);
    await mouse.move(x, y);
    await mouse.down();
    await mouse.move(x + 80, y, { steps: 4 });
    await mouse.up();
    await eventually(
      "the camera",
      () => cameraPlace(viewer),
      (now) => distance(before, now) > 0.1,
    );
  };
  const at = await seen(viewer, vertex);
  await drag(at.x, at.y + 330);
  await keyboard.down("Alt");
  const now = await seen(viewer, vertex);
  await drag(now.x, now.y);
  await keyboard.up("Alt");
  assert.ok(
    client.messages.every(({ params }) => !params?.hands?.length),
    "nobody pulled",
  );
  await client.close();
});

browserTest("the wheel takes what is held away along the view, and brings it back", async () => {
  const { viewer, client } = await hang("wheel", 1440, 900);
  const { mouse } = viewer.page;
  const from = await seen(viewer, vertex);
  await mouse.move(from.x, from.y);
  await mouse.down();
  const held = (await handsOf(client, (all) => all.length === 1)).hands[0];
  const camera = await cameraPlace(viewer);
  const start = distance(held.target, camera);
  await mouse.wheel(0, -240);
  const far = (await handsOf(client, ([one]) => one && distance(one.target, camera) > start * 1.1)).hands[0];
  await eventually(
    "the cloth",
    () => placeOf(client, held.vertex),
    (at) => distance(at, camera) > start * 1.03 && distance(at, far.target) < distance(held.target, far.target),
  );
  await mouse.wheel(0, 480);
  await handsOf(client, ([one]) => one && distance(one.target, camera) < start * 0.95);
  // As far as the wheel turns: to four times the distance at the press, also after the cloth has come along.
  const farthest = 4.05 * start;
  await mouse.wheel(0, -20_000);
  await handsOf(client, ([one]) => one && distance(one.target, camera) > 3 * start);
  await eventually(
    "the cloth comes along",
    () => placeOf(client, held.vertex),
    (at) => distance(at, camera) > start * 1.05,
  );
  await mouse.wheel(0, -20_000);
  await viewer.page.waitForTimeout(300);
  const [end] = (await handsOf(client, (all) => all.length === 1)).hands;
  assert.ok(distance(end.target, camera) < farthest, `${distance(end.target, camera)} m, at most ${farthest}`);
  const afterwards = await cameraPlace(viewer);
  assert.ok(distance(camera, afterwards) < 0.02, `the camera did not zoom: ${camera} to ${afterwards}`);
  await mouse.up();
  await client.close();
});

browserTest("P pins what the mouse holds where it is, a click chooses the pin, Delete takes it off", async () => {
  const { viewer, client, scene } = await hang("pin", 1440, 900);
  const { mouse, keyboard } = viewer.page;
  const from = await seen(viewer, vertex);
  await mouse.move(from.x, from.y);
  await mouse.down();
  const held = (await handsOf(client, (all) => all.length === 1)).hands[0].vertex;
  const goal = { x: from.x + 120, y: from.y - 80 };
  await mouse.move(goal.x, goal.y, { steps: 6 });
  await near(viewer, held, goal, "the vertex follows");
  await keyboard.press("p");
  await eventually(
    "the pins",
    async () => (await scene()).cloths[0].pins.length,
    (count) => count === 4,
  );
  await mouse.up();
  await handsOf(client, (all) => all.length === 0);
  const pin = (await scene()).cloths[0].pins[3];
  assert.equal(pin.at, `vertex:${held}`);
  const { time } = await client.nextFrame();
  for (let i = 0; i < 10; ++i) assert.ok(distance(await placeOf(client, held), pin.place) < 1e-4);
  assert.ok((await client.nextFrame()).time > time, "time goes on");
  const marker = await seen(viewer, held);
  await mouse.click(marker.x, marker.y);
  assert.match(await hint(viewer).innerText(), /Delete or P takes it off/);
  assert.equal(await viewer.page.locator(".hands .pin").count(), 1);
  await viewer.page.screenshot({ path: `${screenshots}grab-pin.png` });
  await keyboard.press("Delete");
  await eventually(
    "the pins",
    async () => (await scene()).cloths[0].pins.length,
    (count) => count === 3,
  );
  assert.equal(await hint(viewer).isVisible(), false);
  assert.deepEqual(complaints(viewer), []);
  await client.close();
});

browserTest("what the hand takes before the server has set a pin is not let go when it has", async () => {
  const { viewer, client, scene } = await hang("late", 1440, 900);
  const { mouse, keyboard } = viewer.page;
  const [first, second] = [await seen(viewer, vertex), await seen(viewer, vertex - 4)];
  await mouse.move(first.x, first.y);
  await mouse.down();
  const held = (await handsOf(client, (all) => all.length === 1)).hands[0].vertex;
  here.server.child.kill("SIGSTOP");
  try {
    await keyboard.press("p");
    await mouse.up();
    await mouse.move(second.x, second.y);
    await mouse.down();
  } finally {
    here.server.child.kill("SIGCONT");
  }
  await eventually(
    "the pins",
    async () => (await scene()).cloths[0].pins.length,
    (count) => count === 4,
  );
  await viewer.page.waitForTimeout(500);
  const { hands } = await handsOf(client, () => true);
  assert.equal(hands.length, 1);
  assert.notEqual(hands[0].vertex, held);
  await mouse.up();
  await handsOf(client, (all) => all.length === 0);
  await client.close();
});

browserTest(
  "without pointing: G grabs the middle, arrows pull, P pins, N and P take it off, Enter lets go",
  async () => {
    const { viewer, client, scene } = await hang("keys", 1440, 900);
    const { keyboard } = viewer.page;
    await viewer.page.locator("#view").focus();
    await keyboard.press("g");
    const { vertex: held, target: start } = (await handsOf(client, (all) => all.length === 1)).hands[0];
    const camera = await cameraPlace(viewer);
    for (let i = 0; i < 6; ++i) await keyboard.press("ArrowRight");
    for (let i = 0; i < 4; ++i) await keyboard.press("ArrowUp");
    for (let i = 0; i < 3; ++i) await keyboard.press("PageUp");
    await keyboard.press("+");
    const right = await viewer.page.evaluate(() => {
      const { camera, controls } = window.clothlab.stage;
      return controls.target.clone().setFromMatrixColumn(camera.matrixWorld, 0).toArray();
    });
    const along = (target) => target.reduce((sum, value, axis) => sum + (value - start[axis]) * right[axis], 0);
    const { hands } = await handsOf(client, ([one]) => one && along(one.target) > 0.05);
    await eventually(
      "the cloth",
      () => placeOf(client, held),
      (at) => distance(at, hands[0].target) < distance(start, hands[0].target),
    );
    assert.ok(distance(camera, await cameraPlace(viewer)) < 0.02, "the keys are the hand's, not the camera's");
    await keyboard.press("p");
    await eventually(
      "the pins",
      async () => (await scene()).cloths[0].pins.length,
      (count) => count === 4,
    );
    await handsOf(client, (all) => all.length === 0);
    await viewer.until(() => window.clothlab.document.cloths[0].pins.length === 4);
    for (let i = 0; i < 4; ++i) await keyboard.press("n"); // the fourth pin
    await keyboard.press("p");
    await eventually(
      "the pins",
      async () => (await scene()).cloths[0].pins.length,
      (count) => count === 3,
    );
    assert.ok((await scene()).cloths[0].pins.every(({ at }) => at.startsWith("corner")));
    await keyboard.press("g");
    await handsOf(client, (all) => all.length === 1);
    await keyboard.press("Enter");
    await handsOf(client, (all) => all.length === 0);
    const before = await cameraPlace(viewer);
    await keyboard.press("ArrowRight");
    await eventually(
      "the camera",
      () => cameraPlace(viewer),
      (now) => distance(before, now) > 0.05,
    );
    await client.close();
  },
);

/// Fingers on the page, by the browser's own input.
async function fingers(viewer) {
  const devtools = await viewer.page.context().newCDPSession(viewer.page);
  const send = (type, ...touchPoints) => devtools.send("Input.dispatchTouchEvent", { type, touchPoints });
  return {
    down: (...points) => send("touchStart", ...points),
    move: (...points) => send("touchMove", ...points),
    up: () => send("touchEnd"),
    async drag(from, to, steps = 8) {
      for (let i = 1; i <= steps; ++i) {
        const share = i / steps;
        await send("touchMove", { x: from.x + (to.x - from.x) * share, y: from.y + (to.y - from.y) * share, id: 0 });
      }
    },
  };
}

browserTest("a finger pulls, a second one takes it farther, and one that keeps still pins", async () => {
  const { viewer, client, scene } = await hang("finger", 390, 844);
  const touch = await fingers(viewer);
  const from = await seen(viewer, vertex);
  const at = { ...from, id: 0 };
  await touch.down(at);
  const held = (await handsOf(client, (all) => all.length === 1)).hands[0].vertex;
  const goal = { x: from.x + 50, y: from.y - 50 };
  await touch.drag(from, goal);
  await near(viewer, held, goal, "the vertex follows the finger");
  const camera = await cameraPlace(viewer);
  const { target } = (await handsOf(client, (all) => all.length === 1)).hands[0];
  const first = { ...goal, id: 0 };
  await touch.down(first, { x: 60, y: 600, id: 1 });
  await touch.move(first, { x: 60, y: 560, id: 1 });
  await handsOf(client, ([one]) => one && distance(one.target, camera) > distance(target, camera) * 1.1);
  await touch.move(first, { x: 60, y: 600, id: 1 });
  await touch.move(first); // the second one has left
  assert.match(await hint(viewer).innerText(), /Keep still/);
  await eventually(
    "the hint",
    () => hint(viewer).innerText(),
    (words) => /Lift the finger/.test(words),
  );
  await viewer.page.screenshot({ path: `${screenshots}grab-finger.png` });
  await touch.up();
  await eventually(
    "the pins",
    async () => (await scene()).cloths[0].pins.length,
    (count) => count === 4,
  );
  await handsOf(client, (all) => all.length === 0);
  // A tap on the pin chooses it, and a button takes it off.
  const marker = { ...(await seen(viewer, held)), id: 0 };
  await touch.down(marker);
  await touch.up();
  await viewer.page.getByRole("button", { name: "Take off" }).click();
  await eventually(
    "the pins",
    async () => (await scene()).cloths[0].pins.length,
    (count) => count === 3,
  );
  // A finger that pulls and leaves at once drops.
  await touch.down(at);
  await handsOf(client, (all) => all.length === 1);
  await touch.drag(from, goal, 4);
  await touch.up();
  await handsOf(client, (all) => all.length === 0);
  assert.equal((await scene()).cloths[0].pins.length, 3);
  assert.deepEqual(complaints(viewer), []);
  await client.close();
});

browserTest("two fingers at once on the cloth zoom, as beside it", async () => {
  const { viewer, client } = await hang("pinch", 390, 844);
  const touch = await fingers(viewer);
  const { x, y } = await seen(viewer, vertex);
  const before = await cameraPlace(viewer);
  const pair = (apart) => [
    { x: x - apart, y, id: 0 },
    { x: x + apart, y, id: 1 },
  ];
  await touch.down(pair(20)[0]);
  await touch.down(...pair(20));
  for (let apart = 25; apart <= 90; apart += 5) await touch.move(...pair(apart));
  await touch.up();
  await eventually(
    "the camera",
    () => cameraPlace(viewer),
    (now) => distance(before, now) > 0.2,
  );
  await handsOf(client, (all) => all.length === 0);
  await client.close();
});

browserTest("another viewer's hand is marked, and a reset ends mine", async () => {
  const { viewer, client } = await hang("others", 1440, 900);
  client.notify("grab.start", { cloth: 0, vertex, target: [0.1, 0.6, 0.3] });
  await eventually(
    "the mark",
    () => viewer.page.locator(".hands .other").count(),
    (count) => count === 1,
  );
  const from = await seen(viewer, 2 * columns + 2); // near a pin it hardly moves meanwhile
  await viewer.page.mouse.move(from.x, from.y);
  await viewer.page.mouse.down();
  await handsOf(client, (all) => all.length === 2);
  await client.request("sim.reset", {});
  await eventually(
    "the mark",
    () => viewer.page.locator(".hands .mine").count(),
    (count) => count === 0,
  );
  await viewer.page.mouse.up();
  await client.close();
});

// Bodies beside the cloth.
const furnished = {
  ...sheet,
  name: "furnished",
  colliders: [
    { name: "ball", sphere: { center: [0.75, 0.6, 0.2], radius: 0.15 } },
    { name: "table", box: { center: [-0.75, 0.5, 0.2], half: [0.15, 0.1, 0.1] } },
    { name: "arm", capsule: { a: [0.6, 0.2, 0.3], b: [0.9, 0.2, 0.3], radius: 0.06 } },
  ],
};

/// Where a place of the scene is on the page [CSS pixels], and how large handles are there [m].
const project = (viewer, place) =>
  viewer.page.evaluate((at) => {
    const { camera, controls } = window.clothlab.stage;
    const point = controls.target.clone().set(...at);
    const far = point.distanceTo(camera.position);
    const size = (far * Math.min((1.9 * Math.tan((Math.PI * camera.fov) / 360)) / camera.zoom, 7) * 0.8) / 4;
    point.project(camera);
    return { x: ((point.x + 1) / 2) * innerWidth, y: ((1 - point.y) / 2) * innerHeight, size };
  }, place);

browserTest(
  "handles move a ball live and turn a box; a drag beside them orbits; arrows and Escape do without",
  async () => {
    const { viewer, client, scene } = await both("handles", { width: 1440, height: 900 });
    await client.request("scene.load", { scene: furnished });
    await viewer.until(() => window.clothlab.document?.name === "furnished" && window.clothlab.simTime > 1);
    await still(viewer, vertex); // the camera follows the cloth
    const { mouse, keyboard } = viewer.page;
    const center = [0.75, 0.6, 0.2];
    const ball = await project(viewer, center);
    await mouse.click(ball.x, ball.y);
    assert.match(await hint(viewer, "body").innerText(), /ball: move it by its handles/);
    await viewer.page.screenshot({ path: `${screenshots}grab-ball.png` });
    const handle = await project(viewer, [center[0] + 0.35 * ball.size, center[1], center[2]]);
    const goal = await project(viewer, [center[0] + 0.35 * ball.size + 0.2, center[1], center[2]]);
    const camera = await cameraPlace(viewer);
    await mouse.move(handle.x, handle.y);
    await mouse.down();
    await mouse.move((handle.x + goal.x) / 2, (handle.y + goal.y) / 2, { steps: 5 });
    const place = async () => (await scene()).colliders[0].sphere.center[0];
    await eventually("the ball, before the drag ends", place, (x) => x > 0.77);
    await mouse.move(goal.x, goal.y, { steps: 5 });
    await mouse.up();
    const moved = await eventually(
      "the ball",
      async () => (await scene()).colliders[0].sphere.center,
      (at) => Math.abs(at[0] - 0.95) < 0.03,
    );
    assert.ok(Math.abs(moved[1] - 0.6) < 1e-4 && Math.abs(moved[2] - 0.2) < 1e-4, "along the handle's axis only");
    assert.ok(distance(camera, await cameraPlace(viewer)) < 0.02, "the camera stayed");

    const table = await project(viewer, [-0.75, 0.5, 0.2]);
    await mouse.click(table.x, table.y);
    await viewer.page.getByRole("button", { name: "Turn" }).click();
    await mouse.move(5, 450);
    await keyboard.press("ArrowRight"); // the button has the focus: it is not the body's
    await viewer.page.locator("#view").focus();
    for (let i = 0; i < 3; ++i) await keyboard.press("ArrowRight");
    const turned = await eventually(
      "the box",
      async () => (await scene()).colliders[1].box,
      ({ rotate }) => Math.abs(Math.hypot(...rotate) - 15) < 2,
    );
    assert.deepEqual(turned.center, [-0.75, 0.5, 0.2]);
    await keyboard.press("t");
    await keyboard.press("ArrowUp");
    await eventually(
      "the box",
      async () => (await scene()).colliders[1].box.center[1],
      (y) => y > 0.51,
    );
    await keyboard.press("b"); // the capsule
    await keyboard.press("ArrowUp");
    await eventually(
      "the capsule",
      async () => (await scene()).colliders[2].capsule,
      ({ a, b }) => a[1] > 0.21 && b[1] > 0.21,
    );
    await keyboard.press("Escape");
    assert.equal(await hint(viewer, "body").isVisible(), false);
    assert.deepEqual(complaints(viewer), []);
    await client.close();
  },
);
