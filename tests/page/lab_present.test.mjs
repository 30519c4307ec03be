// The page's pure code: where the present setting lies on a chart, and the patch that undoes another. Needs no browser.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { placeOf } = await load("lab/present");
const { formerly } = await load("lab/apply");
const { sizeOf, toleranceText } = await load("lab/tolerance");
const { numbersOf } = await load("lab/numbers");

const setting = (method, dt_s, iterations = null, tolerance = null) => ({ method, dt_s, iterations, tolerance });
const point = (of, error, cost, blew_up_at_s = null) => ({
  ...of,
  error: { position: error, energy: null, strain: null, rest: null },
  largest_position_error: error,
  ms_a_simulated_s: cost === null ? null : { median: cost, minimum: cost, runs: 3 },
  blew_up_at_s,
  convergence: null,
  dt_over_limit: null,
  patch: {},
});
const near = (a, b) => assert.ok(Math.abs(a - b) <= 1e-9 * Math.abs(b), `${a} is not ${b}`);

// Error and cost per step are powers of dt, which are straight lines in logarithms: interpolation is exact.
const verlet = [0.0005, 0.001, 0.004].map((dt) => point(setting("verlet", dt), 100 * dt ** 2, 0.05 / dt));

test("between two points of its curve a setting lies on a straight line of logarithms, on a point it is that point", () => {
  const between = placeOf(setting("verlet", 0.002), verlet, "position");
  near(between.error, 100 * 0.002 ** 2);
  near(between.cost, 25);
  const on = placeOf(setting("verlet", 0.001), [...verlet].reverse(), "position");
  near(on.error, 1e-4);
  near(on.cost, 50);
});

test("nothing is guessed beyond what was measured: another method, another step, other iterations or tolerances", () => {
  const vbd = [1, 4].flatMap((n) => [0.001, 0.01].map((dt) => point(setting("vbd", dt, n), dt, n / dt)));
  const implicit = [0.001, 0.01].map((dt) => point(setting("implicit_euler", dt, 1, 1e-4), dt, 1 / dt));
  const all = [...verlet, ...vbd, ...implicit];
  const why = (...of) => placeOf(setting(...of), all, "position").reason;
  assert.match(why("rk4", 0.001), /method is not on the chart/);
  assert.match(why("verlet", 0.0004), /shorter than the shortest step measured, 0.5 ms/);
  assert.match(why("verlet", 0.005), /longer than the longest step measured, 4 ms/);
  assert.match(why("vbd", 0.002, 7), /measured with 1, 4 iterations/);
  assert.match(why("implicit_euler", 0.002, 1, 1e-6), /tolerance 0.0001/);
  near(placeOf(setting("vbd", 0.001, 4), all, "position").cost, 4000);
  assert.match(placeOf(setting("verlet", 0.001), all, "energy").reason, /no point of its curve has this error/);
});

test("the step that the lab has shortened to meet its samples is that of the scene", () => {
  const fitted = [point(setting("verlet", 0.000999), 1e-4, 50)];
  assert.deepEqual(placeOf(setting("verlet", 0.001), fitted, "position"), { error: 1e-4, cost: 50 });
  assert.match(placeOf(setting("verlet", 0.00105), fitted, "position").reason, /longer than the longest/);
});

test("a tolerance is told as a share and as a length of the cloth at rest, however it is turned", () => {
  const cloth = (grid, rotate = [0, 0, 0], scale = 1) => ({ mesh: { grid }, transform: { rotate, scale } });
  const size = (...cloths) => sizeOf({ cloths });
  near(size(cloth({ width: 0.6, height: 1 })), 1);
  near(size(cloth({ width: 0.6, height: 1 }, [90, 0, 0], 2)), 2);
  near(size(cloth({ width: 1, height: 1 }, [0, 45, 0])), Math.SQRT2); // a square on its corner
  near(size(cloth({ width: 0.6, height: 1 }), cloth({ width: 3, height: 1 })), 3);
  assert.equal(size({ ...cloth({}), mesh: { file: "shirt.obj" } }), null);
  assert.equal(toleranceText(0.01, 1), "1 % of the cloth's size = 10 mm");
  assert.equal(toleranceText(0.001, null), "0.1 % of the cloth's size");
});

test("a step between the longest that held and one that blew up has no place, and one beyond it is told so", () => {
  const points = [...verlet, point(setting("verlet", 0.006), null, null, 0.1)];
  assert.match(placeOf(setting("verlet", 0.005), points, "position").reason, /longer than the longest/);
  assert.match(placeOf(setting("verlet", 0.007), points, "position").reason, /blew up/);
  assert.ok(placeOf(setting("verlet", 0.003), points, "position").error > 0);
});

const scene = {
  name: "seed",
  wind: null,
  air_drag: 0,
  self_collision: { thickness: 0.01, friction: 0.2 },
  gravity: [0, -9.8, 0],
  colliders: [],
  cloths: [
    {
      name: "cloth",
      mesh: { grid: { columns: 25 } },
      mass: { per_vertex: 0.1 },
      material: { structural: 20000, bend: 0, strain_limit: null },
    },
  ],
  solver: { method: "verlet", dt: 0.001, iterations: 10, tolerance: 1e-4 },
};

test("what a setting replaces is told in words", () => {
  assert.equal(
    formerly(scene, { solver: { method: "xpbd", dt: 0.01, iterations: 10 } }),
    "method was Verlet, dt was 0.001",
  );
});

test("a stability map is offered over the scene's quantities that are above zero, not over its solver or its mesh", () => {
  const paths = numbersOf(scene).map(({ path }) => path);
  assert.deepEqual(paths, [
    "/cloths/0/mass/per_vertex",
    "/cloths/0/material/structural",
    "/self_collision/thickness",
    "/self_collision/friction",
  ]);
});
