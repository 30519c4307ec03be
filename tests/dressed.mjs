// Garments and bodies made by numbers, for the tests of a start that is led out: shirts with sleeves, of some
// size, on figures of lofted and joined parts, that go through the figure somewhere or through themselves.

/// The mesh of the surface where `f` is 0, by the parts of a grid of `spacing` [m] in the box from `low` to
/// `high`: six tetrahedra a cell, the side where f > 0 outside.
export function surfaceOf(f, low, high, spacing) {
  const counts = low.map((from, i) => Math.ceil((high[i] - from) / spacing) + 1);
  const [nx, ny, nz] = counts;
  const place = (i, j, k) => [low[0] + i * spacing, low[1] + j * spacing, low[2] + k * spacing];
  const number = (i, j, k) => (k * ny + j) * nx + i;
  const values = new Float64Array(nx * ny * nz);
  for (let k = 0; k < nz; ++k)
    for (let j = 0; j < ny; ++j) for (let i = 0; i < nx; ++i) values[number(i, j, k)] = f(place(i, j, k)) || 1e-9;
  const vertices = [];
  const made = new Map();
  const between = (a, b) => {
    const key = a.n < b.n ? a.n * values.length + b.n : b.n * values.length + a.n;
    if (!made.has(key)) {
      const share = Math.min(0.95, Math.max(0.05, values[a.n] / (values[a.n] - values[b.n])));
      made.set(key, vertices.push(a.x.map((from, axis) => from + share * (b.x[axis] - from))) - 1);
    }
    return made.get(key);
  };
  const triangles = [];
  const paths = [
    [1, 2, 4],
    [1, 4, 2],
    [2, 1, 4],
    [2, 4, 1],
    [4, 1, 2],
    [4, 2, 1],
  ];
  for (let k = 0; k + 1 < nz; ++k)
    for (let j = 0; j + 1 < ny; ++j)
      for (let i = 0; i + 1 < nx; ++i)
        for (const [first, second, third] of paths) {
          const corner = (bits) => {
            const at = [i + (bits & 1), j + ((bits >> 1) & 1), k + (bits >> 2)];
            return { n: number(...at), x: place(...at) };
          };
          const four = [0, first, first | second, first | second | third].map(corner);
          const inside = four.filter(({ n }) => values[n] < 0);
          const outside = four.filter(({ n }) => values[n] >= 0);
          if (inside.length === 0 || outside.length === 0) continue;
          let ring = [];
          if (inside.length === 2)
            ring = [
              [0, 0],
              [0, 1],
              [1, 1],
              [1, 0],
            ].map(([a, b]) => between(inside[a], outside[b]));
          else ring = inside.flatMap((a) => outside.map((b) => between(a, b)));
          const way = outside[0].x.map((x, axis) => x - inside[0].x[axis]);
          for (let t = 2; t < ring.length; ++t) {
            const [a, b, c] = [ring[0], ring[t - 1], ring[t]].map((n) => vertices[n]);
            const u = b.map((x, axis) => x - a[axis]);
            const v = c.map((x, axis) => x - a[axis]);
            const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            const turned = normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2] < 0;
            triangles.push(turned ? [ring[0], ring[t], ring[t - 1]] : [ring[0], ring[t - 1], ring[t]]);
          }
        }
  return smoothed({ vertices, triangles });
}

/// With each vertex half way to the middle of its neighbours, twice: triangles of a grid's parts are slivers.
function smoothed({ vertices, triangles }) {
  for (let times = 0; times < 2; ++times) {
    const sums = vertices.map(() => [0, 0, 0, 0]);
    for (const [a, b, c] of triangles)
      for (const [to, from] of [
        [a, b],
        [b, c],
        [c, a],
        [b, a],
        [c, b],
        [a, c],
      ]) {
        for (let axis = 0; axis < 3; ++axis) sums[to][axis] += vertices[from][axis];
        ++sums[to][3];
      }
    vertices = vertices.map((x, i) => x.map((at, axis) => 0.5 * (at + sums[i][axis] / sums[i][3])));
  }
  return { vertices, triangles };
}

/// The parts of a mesh whose triangles' middles are where `kept` says.
export function cut({ vertices, triangles }, kept) {
  const number = new Map();
  const left = triangles.filter((t) =>
    kept([0, 1, 2].map((axis) => t.reduce((sum, n) => sum + vertices[n][axis] / 3, 0))),
  );
  for (const n of left.flat()) if (!number.has(n)) number.set(n, number.size);
  return {
    vertices: [...number.keys()].map((n) => vertices[n]),
    triangles: left.map((t) => t.map((n) => number.get(n))),
  };
}

const minus = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/// How far a point is from a line's piece that is thick by r at a and by s at b.
function fromLimb(x, [a, b, r, s = r]) {
  const along = minus(b, a);
  const share = Math.max(0, Math.min(1, dot(minus(x, a), along) / dot(along, along)));
  return Math.hypot(...x.map((at, i) => at - a[i] - share * along[i])) - (r + share * (s - r));
}

/// The limbs of a figure of 1.7 m. `arm`: degrees by which arms hang below the horizontal; `bend`: of elbows, forwards.
export function limbs({ arm = 30, bend = 0, stout = 1, head = true } = {}) {
  const [down, forward] = [arm, bend].map((degrees) => (degrees * Math.PI) / 180);
  const all = [
    [[0, 0.98, 0], [0, 1.1, 0.01], 0.15 * stout, 0.14 * stout],
    [[0, 1.1, 0.01], [0, 1.33, 0], 0.14 * stout, 0.15 * stout],
    [[-0.08, 1.28, 0], [0.08, 1.28, 0], 0.12 * stout],
  ];
  for (const side of [-1, 1]) {
    const shoulder = [side * 0.17, 1.38, 0];
    const upper = [side * Math.cos(down), -Math.sin(down), 0];
    const elbow = shoulder.map((x, i) => x + 0.28 * upper[i]);
    const lower = [upper[0] * Math.cos(forward), upper[1] * Math.cos(forward), Math.sin(forward)];
    all.push([[side * 0.05, 1.38, 0], shoulder, 0.07 * stout, 0.06 * stout]);
    all.push([shoulder, elbow, 0.055 * stout, 0.045 * stout]);
    all.push([elbow, elbow.map((x, i) => x + 0.25 * lower[i]), 0.045 * stout, 0.035 * stout]);
    all.push([[side * 0.09, 0.95, 0], [side * 0.11, 0.5, 0], 0.085 * stout, 0.06 * stout]);
  }
  if (head) all.push([[0, 1.38, 0], [0, 1.5, 0], 0.055], [[0, 1.58, 0.01], [0, 1.62, 0.01], 0.09]);
  return all;
}

/// Limbs as one surface, with smooth joints `round` [m] wide.
export const joined =
  (parts, round = 0.02) =>
  (x) =>
    -round * Math.log(parts.reduce((sum, limb) => sum + Math.exp(-fromLimb(x, limb) / round), 0));

/// Each limb as a surface of its own, which overlap.
export function apart(parts, spacing) {
  const all = { vertices: [], triangles: [] };
  for (const limb of parts) {
    const [a, b, r, s = r] = limb;
    const reach = Math.max(r, s) + 2 * spacing;
    const low = a.map((x, i) => Math.min(x, b[i]) - reach + 0.1 * spacing * i);
    const high = a.map((x, i) => Math.max(x, b[i]) + reach);
    const one = surfaceOf((x) => fromLimb(x, limb), low, high, spacing);
    const first = all.vertices.length;
    all.vertices.push(...one.vertices);
    all.triangles.push(...one.triangles.map((t) => t.map((n) => n + first)));
  }
  return all;
}

const box = [
  [-0.8, 0.35, -0.35],
  [0.8, 1.75, 0.55],
];
export const figure = (pose, spacing) => surfaceOf(joined(limbs(pose)), ...box, spacing);
/// Without head and with cut wrists: five holes.
export const openFigure = (pose, spacing) =>
  cut(figure(pose, spacing), ([x, y]) => y < 1.45 && Math.abs(x) < 0.5 && y > 0.55);

/// A shirt for a figure of the pose, wider by `ease` [m]: open at the neck, the wrists and the hem at `hem` [m].
export function shirt(pose, ease, spacing, { hem = 0.9, sleeve = 0.45 } = {}) {
  const parts = limbs({ ...pose, head: false }).filter(([a]) => a[1] > 0.96);
  const f = joined(parts);
  const long = surfaceOf((x) => f(x) - ease, ...box, spacing);
  return cut(
    long,
    ([x, y, z]) => y > hem && Math.hypot(x, z) + 0.4 * (1.5 - y) > 0.1 && Math.abs(x) < sleeve && y < 1.55,
  );
}

/// A mesh moved, and turned about the upright through the origin by so many degrees.
export function placed({ vertices, triangles }, [dx, dy, dz], degrees = 0) {
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  return { vertices: vertices.map(([x, y, z]) => [c * x + s * z + dx, y + dy, c * z - s * x + dz]), triangles };
}

/// The lower part of the garment turned about an axis along x through (., y, z), upwards and through what is there.
export function folded({ vertices, triangles }, y, z, degrees, over = 0.1) {
  return {
    vertices: vertices.map(([px, py, pz]) => {
      if (py >= y) return [px, py, pz];
      const share = Math.min(1, (y - py) / over);
      const turn = (share * degrees * Math.PI) / 180;
      const [c, s] = [Math.cos(turn), Math.sin(turn)];
      return [px, y + c * (py - y) - s * (pz - z), z + s * (py - y) + c * (pz - z)];
    }),
    triangles,
  };
}

/// The sleeve of the side where x > 0 turned about the shoulder, through the shirt's own side.
export function sleeveIn({ vertices, triangles }, degrees, [sx, sy] = [0.2, 1.38]) {
  return {
    vertices: vertices.map(([x, y, z]) => {
      if (x < sx) return [x, y, z];
      const turn = (-Math.min(1, (x - sx) / 0.05) * degrees * Math.PI) / 180;
      const [c, s] = [Math.cos(turn), Math.sin(turn)];
      return [sx + c * (x - sx) - s * (y - sy), sy + s * (x - sx) + c * (y - sy), z];
    }),
    triangles,
  };
}

/// A pocket of 12 cm on the front, which stands out above and goes through it below.
function withPocket({ vertices, triangles }, spacing) {
  const count = Math.round(0.12 / spacing) + 1;
  const first = vertices.length;
  const pocket = [];
  for (let row = 0; row < count; ++row)
    for (let column = 0; column < count; ++column) {
      const [u, v] = [column / (count - 1), row / (count - 1)];
      pocket.push([0.12 * u - 0.06, 1.09 + 0.12 * v, 0.165 + 0.04 * v]);
    }
  const cells = [];
  for (let row = 0; row + 1 < count; ++row)
    for (let column = 0; column + 1 < count; ++column) {
      const a = first + row * count + column;
      cells.push([a, a + 1, a + count + 1], [a + count + 1, a + count, a]);
    }
  return { vertices: [...vertices, ...pocket], triangles: [...triangles, ...cells] };
}

/// The pairs: a garment, and a body or none. `fine`: mesh width of the garment [m]; of the body `coarse`.
export function pairs(fine, coarse) {
  const poses = { a: { arm: 30 }, wide: { arm: 5 }, low: { arm: 55 }, bent: { arm: 30, bend: 50 } };
  const stout = { arm: 30, stout: 1.06 };
  return [
    {
      name: "moved forwards",
      cloth: placed(shirt(poses.a, 0.015, fine), [0, 0, 0.025]),
      body: figure(poses.a, coarse),
    },
    { name: "one size too small", cloth: shirt(poses.a, 0.012, fine), body: figure(stout, coarse) },
    { name: "arms lower than sleeves", cloth: shirt(poses.a, 0.02, fine), body: figure({ arm: 36 }, coarse) },
    { name: "bent elbows", cloth: shirt({ arm: 30, bend: 35 }, 0.02, fine), body: figure(poses.bent, coarse) },
    {
      name: "arms out",
      cloth: placed(shirt(poses.wide, 0.01, fine), [0.01, -0.015, -0.01]),
      body: figure(poses.wide, coarse),
    },
    { name: "turned", cloth: placed(shirt(poses.a, 0.015, fine), [0, 0, 0], 5), body: figure(poses.a, coarse) },
    {
      name: "an open figure",
      cloth: placed(shirt(poses.a, 0.015, fine), [0, 0.01, 0.025]),
      body: openFigure(poses.a, coarse),
    },
    {
      name: "limbs that overlap",
      cloth: placed(shirt(poses.low, 0.015, fine), [0, 0, 0.02]),
      body: apart(limbs(poses.low), coarse),
    },
    { name: "pocket half through the front", cloth: withPocket(shirt(poses.a, 0.03, fine), 0.7 * fine), body: null },
    { name: "hem folded through the front", cloth: folded(shirt(poses.a, 0.03, fine), 1.0, 0.12, 200), body: null },
    { name: "sleeve through the side", cloth: sleeveIn(shirt(poses.a, 0.03, fine), 45), body: null },
    {
      name: "sleeve through the side of a figure's shirt",
      cloth: sleeveIn(shirt(poses.a, 0.03, fine), 18),
      body: figure({ arm: 45 }, coarse),
    },
  ];
}

/// As the text of an .obj file.
export const obj = ({ vertices, triangles }) =>
  [
    ...vertices.map((x) => `v ${x.map((at) => at.toFixed(6)).join(" ")}`),
    ...triangles.map((t) => `f ${t.map((n) => n + 1).join(" ")}`),
    "",
  ].join("\n");

/// The scene of a pair whose files are so named.
export const sceneOf = (name, cloth, body, dress) => ({
  version: 1,
  name,
  cloths: [{ mesh: { file: cloth }, material: { fabric: "cotton" }, ...(dress ? { start: { dress } } : {}) }],
  colliders: body ? [{ mesh: { file: body }, friction: 0.3 }] : [],
  self_collision: { kind: "surface", thickness: 0.002, friction: 0.3 },
  solver: { method: "xpbd", dt: 1 / 300 },
});
