// Moving colliders are drawn where the session places them at the time of the frame on screen.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";

const { both } = withServer();

/// Starts anew, pauses half a second of the scene's time later, and waits until the page has drawn the last frame.
async function stopAfterHalfASecond(viewer, client) {
  await client.request("sim.reset", {});
  await eventually(
    "half a second",
    () => viewer.read("simTime"),
    (time) => time > 0.5 && time < 5,
  );
  await client.request("sim.pause", {});
  const { step: last } = await client.nextNotification("sim.status", ({ playing }) => !playing);
  await viewer.until((step) => window.clothlab.step === step, last);
  await viewer.still();
}

browserTest(
  "a capsule and a box that spin are on the screen where the session says, and turned as it says",
  async () => {
    const { viewer, client } = await both("bodies");
    const spin = { axis: [0, 1, 0], center: [0, 0.2, 0], degrees_per_second: 60 };
    await client.request("scene.patch", {
      patch: {
        colliders: [
          { capsule: { a: [0.2, 0.2, 0], b: [0.6, 0.4, 0], radius: 0.1 }, motion: { spin } },
          { box: { center: [0, 0.2, 0], half: [0.2, 0.1, 0.15], rotate: [20, 30, 40] }, motion: { spin } },
          { box: { center: [0, -0.4, 0], half: [0.2, 0.1, 0.15], rotate: [20, 30, 40] } },
        ],
      },
    });
    await viewer.until(() => window.clothlab.document?.colliders.length === 3);
    await stopAfterHalfASecond(viewer, client);
    const seen = await viewer.page.evaluate(() => {
      const { stage, simTime } = window.clothlab;
      const at = (mesh, ...point) => mesh.localToWorld(mesh.position.clone().set(...point)).toArray();
      const [capsule, box, still] = stage.colliders.shown.map(({ mesh }) => mesh);
      for (const mesh of [capsule, box, still]) mesh.updateMatrixWorld();
      // A capsule's geometry is along its own y axis, in radii; a box's edges are along its own axes.
      const half = Math.hypot(0.4, 0.2) / 2 / capsule.scale.y;
      return {
        time: simTime,
        ends: [at(capsule, 0, -half, 0), at(capsule, 0, half, 0)],
        length: capsule.geometry.parameters.height * capsule.scale.y,
        corner: at(box, 0.2, 0.1, 0.15),
        still: at(still, 0.2, 0.1, 0.15),
      };
    });
    const near = (found, wanted, what) =>
      assert.ok(
        Math.hypot(...found.map((value, axis) => value - wanted[axis])) < 1e-6,
        `${what} at ${seen.time} s: ${found}, not ${wanted}`,
      );
    const about = (axis, degrees) => (v) => {
      const [p, q] = [(axis + 1) % 3, (axis + 2) % 3];
      const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
      const turned = [...v];
      [turned[p], turned[q]] = [c * v[p] - s * v[q], s * v[p] + c * v[q]];
      return turned;
    };
    const spun = about(1, 60 * seen.time);
    near([seen.length], [Math.hypot(0.4, 0.2)], "the capsule's length");
    near(seen.ends[0], spun([0.2, 0.2, 0]), "the capsule's one end");
    near(seen.ends[1], spun([0.6, 0.4, 0]), "the capsule's other end");
    const corner = about(2, 40)(about(1, 30)(about(0, 20)([0.2, 0.1, 0.15])));
    near(
      seen.corner,
      spun(corner).map((value, axis) => value + [0, 0.2, 0][axis]),
      "the box's corner",
    );
    near(
      seen.still,
      corner.map((value, axis) => value + [0, -0.4, 0][axis]),
      "the still box's corner",
    );
  },
);

browserTest(
  "a plane that spins turns on the screen, and a sphere that swings is where it is in the frame",
  async () => {
    const { viewer, client } = await both("spinning");
    const spin = { axis: [0, 0, 1], center: [0, 0.2, 0], degrees_per_second: 60 };
    const oscillate = { axis: [1, 0, 0], amplitude: 0.3, frequency: 0.5 };
    await client.request("scene.patch", {
      patch: {
        colliders: [
          { name: "table", plane: { point: [0.3, 0.2, 0], normal: [0, 1, 0] }, motion: { spin } },
          { name: "ball", sphere: { center: [0, 0.6, 0], radius: 0.2 }, motion: { oscillate } },
        ],
      },
    });
    await viewer.until(() => window.clothlab.document?.colliders.length === 2);
    await stopAfterHalfASecond(viewer, client);
    const { time, normal, table, ball } = await viewer.page.evaluate(() => {
      const { stage, simTime } = window.clothlab;
      const [table, ball] = stage.colliders.shown.map(({ mesh }) => mesh);
      // A disc faces along its own z axis.
      const normal = table.position.clone().set(0, 0, 1).applyQuaternion(table.quaternion).toArray();
      return { time: simTime, normal, table: table.position.toArray(), ball: ball.position.toArray() };
    });
    const near = (found, wanted, what) =>
      assert.ok(
        Math.hypot(...found.map((value, axis) => value - wanted[axis])) < 1e-6,
        `${what} at ${time} s: ${found}, not ${wanted}`,
      );
    const angle = (Math.PI / 3) * time;
    near(normal, [-Math.sin(angle), Math.cos(angle), 0], "the table's normal");
    near(table, [0.3 * Math.cos(angle), 0.2 + 0.3 * Math.sin(angle), 0], "the table's point");
    near(ball, [0.3 * Math.sin(Math.PI * time), 0.6, 0], "the ball");
  },
);

/// A roof: two squares that meet in a ridge along x at y = 0.1.
const roof = {
  vertices: [
    [-0.2, 0, -0.2],
    [0.2, 0, -0.2],
    [0.2, 0.1, 0],
    [-0.2, 0.1, 0],
    [0.2, 0, 0.2],
    [-0.2, 0, 0.2],
  ],
  triangles: [
    [0, 2, 1],
    [0, 3, 2],
    [3, 4, 2],
    [3, 5, 4],
  ],
};

browserTest(
  "meshes, from the document and from a file, are on the screen where the session says they are",
  async () => {
    const { viewer, client } = await both("meshes", { sharp: true });
    const spin = { axis: [0, 1, 0], center: [0, 0, 0], degrees_per_second: 60 };
    await client.request("scene.load", {
      scene: {
        version: 1,
        name: "meshes",
        cloths: [
          {
            mesh: { grid: { columns: 9, rows: 9, width: 0.5, height: 0.5 } },
            transform: { translate: [0, 1.7, -0.25] },
            pins: [{ at: "edge:row:0" }],
          },
        ],
        colliders: [
          { name: "dummy", mesh: { obj: "presets/torso.obj" }, motion: { spin } },
          {
            name: "roof",
            mesh: roof,
            transform: { translate: [0.6, 1, 0], rotate: [0, 0, 20], scale: 1.5 },
            motion: { spin },
          },
          { name: "floor", plane: { point: [0, 0, 0], normal: [0, 1, 0] } },
        ],
      },
    });
    await viewer.until(() => window.clothlab.document?.name === "meshes");
    await stopAfterHalfASecond(viewer, client);
    await viewer.until(() => window.clothlab.stage.colliders.shown[0].mesh.geometry.index.count === 3 * 2880);
    const seen = await viewer.page.evaluate(() => {
      const { stage, simTime } = window.clothlab;
      const [dummy, roof] = stage.colliders.shown.map(({ mesh }) => mesh);
      for (const mesh of [dummy, roof]) mesh.updateMatrixWorld();
      const corner = (mesh, vertex) => {
        const places = mesh.geometry.getAttribute("position");
        return mesh.localToWorld(mesh.position.clone().fromBufferAttribute(places, vertex)).toArray();
      };
      return {
        time: simTime,
        dummy: corner(dummy, 0),
        roof: corner(roof, 2),
        casters: stage.colliders.caster.children.length,
      };
    });
    const near = (found, wanted, what) =>
      assert.ok(
        Math.hypot(...found.map((value, axis) => value - wanted[axis])) < 1e-5,
        `${what} at ${seen.time} s: ${found}, not ${wanted}`,
      );
    const [c, s] = [Math.cos((Math.PI / 3) * seen.time), Math.sin((Math.PI / 3) * seen.time)];
    const spun = ([x, y, z]) => [c * x + s * z, y, -s * x + c * z];
    near(seen.dummy, spun([0.13, 0.8, 0]), "the dummy's first vertex");
    const [a, b] = [Math.cos(Math.PI / 9), Math.sin(Math.PI / 9)];
    near(seen.roof, spun([0.6 + 1.5 * (0.2 * a - 0.1 * b), 1 + 1.5 * (0.2 * b + 0.1 * a), 0]), "the roof's ridge");
    assert.equal(seen.casters, 2);
    await viewer.page.screenshot({ path: `${screenshots}meshes.png` });
    // They are seen: without them the picture is another one.
    const pictures = [];
    for (const visible of [true, false]) {
      await viewer.page.evaluate((visible) => {
        for (const { mesh } of window.clothlab.stage.colliders.shown.slice(0, 2)) mesh.visible = visible;
        window.clothlab.stage.invalidate();
      }, visible);
      await viewer.still();
      pictures.push(await viewer.page.locator("canvas").first().screenshot());
    }
    assert.notDeepEqual(pictures[0], pictures[1]);
    assert.deepEqual(viewer.complaints, []);
    // Where cloth would start through it, the page says so.
    await viewer.slider("Collider: dummy", "place y");
    const height = viewer.number("Collider: dummy", "place y");
    await height.fill("0.2");
    await height.press("Enter");
    const refusal = viewer.page.locator("#notices .notice", { hasText: "Not applied" });
    await refusal.waitFor();
    assert.match(await refusal.textContent(), /passing through a body, in \d+ places/);
    assert.match(await refusal.textContent(), /of dummy/);
    assert.equal(await refusal.getByRole("button", { name: "Use points instead" }).count(), 0);
    await refusal.getByRole("button", { name: "Show me" }).click();
    await viewer.page.waitForTimeout(600);
    await viewer.page.screenshot({ path: `${screenshots}mesh-crossed.png` });
    // A field places it anew; a mesh that was uploaded again is drawn as it is now.
    await client.request("scene.patch", { patch: [{ op: "replace", path: "/colliders/0/motion", value: null }] });
    const across = viewer.number("Collider: dummy", "place x");
    await across.fill("-0.4");
    await across.press("Enter");
    await viewer.until(() => Math.abs(window.clothlab.stage.colliders.shown[0].mesh.position.x + 0.4) < 1e-9);
    await client.request("mesh.upload", { name: "hut", obj: "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n" });
    await client.request("scene.patch", {
      patch: [{ op: "replace", path: "/colliders/0/mesh", value: { obj: "hut" } }],
    });
    const triangles = () =>
      viewer.page.evaluate(() => window.clothlab.stage.colliders.shown[0].mesh.geometry.index.count / 3);
    await eventually("the hut", triangles, (count) => count === 1);
    await client.request("mesh.upload", { name: "hut", obj: "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 2 4 3\n" });
    await eventually("the other hut", triangles, (count) => count === 2);
  },
);
