// Reads the answers of inspect.*, and finds near pairs by brute force over all of a scene, for a comparison.
import assert from "node:assert/strict";

/// The arrays of an answer: `layout` has their type, and how many numbers an item has.
export function arrays(answer, layout) {
  return Object.fromEntries(
    Object.entries(layout).map(([key, [Type, many]]) => {
      const bytes = Buffer.from(answer[key], "base64");
      assert.equal(bytes.length, answer.count * many * Type.BYTES_PER_ELEMENT, key);
      return [key, new Type(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length))];
    }),
  );
}

const none = 0xffffffff;
export const [vertexVertex, vertexTriangle, edgeEdge, vertexSolid] = [0, 1, 2, 3];

/// The pairs of an answer: each part as vertices with their shares.
export function nearest(answer) {
  const { kind, vertices, shares, gap, keep, nearest } = arrays(answer, {
    kind: [Uint8Array, 1],
    vertices: [Uint32Array, 4],
    shares: [Float32Array, 4],
    gap: [Float32Array, 1],
    keep: [Float32Array, 1],
    nearest: [Float32Array, 6],
  });
  return [...kind].map((of, i) => {
    const corners = [0, 1, 2, 3]
      .map((k) => [vertices[4 * i + k], shares[4 * i + k]])
      .filter(([vertex]) => vertex !== none);
    const first = of === edgeEdge ? 2 : 1;
    const parts = [corners.slice(0, first), corners.slice(first)];
    for (const part of of === vertexSolid ? parts.slice(0, 1) : parts)
      assert.ok(Math.abs(part.reduce((sum, [, share]) => sum + share, 0) - 1) < 1e-5, "shares add up to 1");
    const points = [nearest.slice(6 * i, 6 * i + 3), nearest.slice(6 * i + 3, 6 * i + 6)];
    return { kind: of, parts, gap: gap[i], keep: keep[i], nearest: points.map((point) => [...point]) };
  });
}

/// Which pair it is, whichever of two like parts comes first.
const key = ({ kind, parts }) => {
  const names = parts.map((part) =>
    part
      .map(([vertex]) => vertex)
      .sort((a, b) => a - b)
      .join("-"),
  );
  if (kind === vertexVertex || kind === edgeEdge) names.sort();
  return `${kind} ${names.join(" ")}`;
};
export const same = (one, other) => key(one) === key(other);

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);

/// How far a point is from a plane through a triangle, if the foot is within it; with the least share of a corner.
function overTriangle(x, [a, b, c]) {
  const normal = cross(minus(b, a), minus(c, a)),
    area = length(normal);
  const height = dot(minus(x, a), normal) / area;
  const foot = minus(x, times(height / area, normal));
  const share = (p, q) => dot(cross(minus(q, p), minus(foot, p)), normal) / area ** 2;
  return { gap: Math.abs(height), within: Math.min(share(a, b), share(b, c), share(c, a)) };
}
/// The same for the common normal of two edges.
function betweenEdges([a, b], [c, d]) {
  const u = minus(b, a),
    v = minus(d, c),
    w = minus(a, c);
  const normal = cross(u, v),
    squared = dot(normal, normal);
  const s = dot(cross(v, w), normal) / squared,
    t = dot(cross(u, w), normal) / squared;
  const gap = length(minus(plus(a, times(s, u)), plus(c, times(t, v))));
  return { gap, within: Math.min(s, 1 - s, t, 1 - t) };
}

/// A vertex's distance from a solid, at a time.
function fromSolid(collider, x, time) {
  const { oscillate } = collider.motion ?? {};
  const moved = oscillate
    ? minus(x, times(oscillate.amplitude * Math.sin(2 * Math.PI * oscillate.frequency * time), oscillate.axis))
    : x;
  const { sphere, plane, capsule, box } = collider;
  if (sphere) return length(minus(moved, sphere.center)) - sphere.radius;
  if (plane) return dot(minus(moved, plane.point), plane.normal) / length(plane.normal);
  if (capsule) {
    const along = minus(capsule.b, capsule.a),
      share = dot(minus(moved, capsule.a), along) / dot(along, along);
    return length(minus(moved, plus(capsule.a, times(Math.min(1, Math.max(0, share)), along)))) - capsule.radius;
  }
  // Back through the rotations about z, y and x, each a fixed axis.
  const local = minus(moved, box.center);
  for (const axis of [2, 1, 0]) {
    const angle = (-box.rotate[axis] * Math.PI) / 180,
      [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
    const [p, q] = [local[i], local[j]];
    local[i] = Math.cos(angle) * p - Math.sin(angle) * q;
    local[j] = Math.sin(angle) * p + Math.cos(angle) * q;
  }
  const out = local.map((value, axis) => Math.abs(value) - box.half[axis]);
  return length(out.map((value) => Math.max(value, 0))) + Math.min(Math.max(...out), 0);
}

/// Pairs of a scene's two cloths, and of their vertices and solids: `near`, that can be told, with the distances that
/// they have and are kept; `close`, that must be told, whatever the last search listed.
export function nearByBruteForce({ self_collision, colliders, cloths }, x, { triangles, cloths: ranges }, time) {
  const near = [],
    rounding = 1e-6;
  const add = (kind, parts, gap, keep, within = 1) => {
    if (gap < 1.5 * keep + rounding && within > -1e-4)
      near.push({ kind, parts: parts.map((part) => part.map((vertex) => [vertex])), gap, keep, within });
  };
  const upper = ranges[1].firstVertex;
  const place = (vertices) => vertices.map((vertex) => x[vertex]);
  const both = (list) => [list.filter(([v]) => v < upper), list.filter(([v]) => v >= upper)];
  const edges = [
    ...new Set(
      triangles.flatMap(([a, b, c]) =>
        [
          [a, b],
          [b, c],
          [c, a],
        ].map(([v, w]) => (v < w ? `${v} ${w}` : `${w} ${v}`)),
      ),
    ),
  ].map((edge) => edge.split(" ").map(Number));
  const all = x.map((_, vertex) => [vertex]);
  const thickness = self_collision?.thickness;
  if (self_collision?.kind === "points")
    for (const [v] of both(all)[0])
      for (const [w] of both(all)[1]) add(vertexVertex, [[v], [w]], length(minus(x[v], x[w])), thickness);
  if (self_collision?.kind === "surface") {
    for (const turned of [false, true]) {
      const [vertices, faces] = [both(all)[turned ? 1 : 0], both(triangles)[turned ? 0 : 1]];
      for (const [v] of vertices)
        for (const face of faces) {
          const { gap, within } = overTriangle(x[v], place(face));
          add(vertexTriangle, [[v], face], gap, thickness, within);
        }
    }
    for (const one of both(edges)[0])
      for (const other of both(edges)[1]) {
        const { gap, within } = betweenEdges(place(one), place(other));
        add(edgeEdge, [one, other], gap, thickness, within);
      }
  }
  const grid = cloths[0].mesh.grid;
  // As the server keeps vertices from solids: half of the thickness, or a hundredth of the mean edge.
  const cell = grid.width / (grid.columns - 1);
  const margin = thickness ? thickness / 2 : (0.01 * cell * (2 + Math.SQRT2)) / 3;
  const held = new Set(cloths[0].pins.length > 0 ? rim(grid) : []);
  for (const [v] of all)
    for (const [number, collider] of (colliders ?? []).entries())
      if (!held.has(v)) add(vertexSolid, [[v], [number]], fromSolid(collider, x[v], time), margin);
  const complete = (kind) => (kind === vertexSolid ? 1.5 : 1); // of solids all that are near
  const close = near.filter(({ kind, gap, keep, within }) => gap < complete(kind) * keep - rounding && within > 1e-4);
  return { near, close };
}

const rim = ({ columns, rows }) =>
  Array.from({ length: columns * rows }, (_, i) => i).filter((i) => {
    const [column, row] = [i % columns, Math.floor(i / columns)];
    return column === 0 || row === 0 || column === columns - 1 || row === rows - 1;
  });

/// Makes a cloth of springs one of finite elements.
export const finiteElements = [
  {
    op: "replace",
    path: "/cloths/0/material",
    value: { model: "fem", warp: 200, weft: 100, shear: 20, damping: 0.001 },
  },
  { op: "replace", path: "/cloths/0/mass", value: { area_density: 0.15 } },
  { op: "replace", path: "/solver/dt", value: 0.0002 },
];
