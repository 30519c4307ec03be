// Writes skirt.obj and poncho.obj beside it, rings of vertices around an axis, about `spacing` [m] apart, joined by
// triangles; and knot.obj. `node server/scene/presets/garments.mjs`
import { writeFileSync } from "node:fs";

const spacing = 0.03;
const number = (x) => String(Number(x.toFixed(5)) + 0); // + 0: no "-0"

/// Rings of counts[i] vertices each, all of which start at the same angle. `half` 0 or 1: triangles of the turn's first
/// or second half, as [ring, index] corners. Both halves have a vertex of each ring at their two ends.
function strip(counts, half) {
  const triangles = [];
  for (let ring = 0; ring + 1 < counts.length; ring++) {
    const [inner, outer] = [counts[ring] / 2, counts[ring + 1] / 2];
    for (let i = 0, j = 0; i < inner || j < outer; ) {
      // The side that lies further back takes the next step.
      const outward = i === inner || (j < outer && (j + 1) * inner <= (i + 1) * outer);
      const a = [ring, half * inner + i];
      const b = [ring + 1, half * outer + j];
      triangles.push([a, b, outward ? [ring + 1, half * outer + ++j] : [ring, half * inner + ++i]]);
    }
  }
  return triangles;
}

function write(name, comment, counts, place, pattern) {
  const first = counts.map((_, ring) => counts.slice(0, ring).reduce((sum, n) => sum + n, 0));
  const lines = comment.map((line) => `# ${line}`);
  lines.push("# Made by garments.mjs.");
  counts.forEach((n, ring) => {
    for (let i = 0; i < n; i++) lines.push(`v ${place(ring, i / n).map(number).join(" ")}`);
  });
  const faces = [];
  let textures = 0;
  for (const half of [0, 1]) {
    const known = new Map();
    const corner = ([ring, i]) => {
      const vertex = first[ring] + (i % counts[ring]) + 1;
      if (!pattern) return vertex;
      const key = `${ring} ${i}`;
      if (!known.has(key)) {
        known.set(key, ++textures);
        lines.push(`vt ${pattern(ring, i / counts[ring], half).map(number).join(" ")}`);
      }
      return `${vertex}/${known.get(key)}`;
    };
    for (const triangle of strip(counts, half)) faces.push(`f ${triangle.map(corner).join(" ")}`);
  }
  writeFileSync(new URL(name, import.meta.url), `${[...lines, ...faces].join("\n")}\n`);
  console.log(name, first.at(-1) + counts.at(-1), "vertices,", faces.length, "triangles");
}

const even = (x) => 2 * Math.round(x / 2);

// A skirt of two panels, each a sector of a ring of 140 degrees: sewn together they make a cone.
{
  const share = (2 * 140) / 360; // of a full circle of cloth: the sine of half the cone's angle
  const waist = 0.13;
  const length = 0.52;
  const rings = Math.round(length / spacing) + 1;
  const along = (ring) => waist / share + (length * ring) / (rings - 1); // from the cone's tip
  const counts = Array.from({ length: rings }, (_, ring) => even((2 * Math.PI * share * along(ring)) / spacing));
  const drop = Math.sqrt(1 - share * share);
  const place = (ring, turn) => {
    const angle = 2 * Math.PI * turn;
    const radius = share * along(ring);
    return [radius * Math.sin(angle), -drop * (along(ring) - along(0)), radius * Math.cos(angle)];
  };
  const pattern = (ring, turn, half) => {
    const angle = 2 * Math.PI * share * (turn - 0.25 - half / 2);
    return [along(ring) * Math.sin(angle) + 1.5 * half, -along(ring) * Math.cos(angle)];
  };
  const comment = ["A skirt: two panels, each 140 degrees of a ring. Its seams are at z > 0 and z < 0, its waist at y = 0."];
  write("skirt.obj", comment, counts, place, pattern);
}

// A poncho: a square with a round hole for the neck. It is flat, and so its own pattern.
{
  const neck = 0.105;
  const side = 0.5; // half of it
  const rings = Math.round((side - neck) / spacing) + 1;
  const counts = Array.from({ length: rings }, (_, ring) => {
    const radius = neck + ((side - neck) * ring) / (rings - 1);
    return 4 * Math.round(((2 * Math.PI * radius * (1 + (0.27 * ring) / (rings - 1))) / spacing) / 4);
  });
  const place = (ring, turn) => {
    const angle = 2 * Math.PI * (turn + 1 / 8);
    const out = ring / (rings - 1);
    // Along the square's sides vertices are evenly spaced, around the neck they are so by angle.
    const corner = Math.floor(turn * 4) / 4;
    const t = (turn - corner) * 4;
    const ends = [corner, corner + 0.25].map((c) => 2 * Math.PI * (c + 1 / 8));
    const square = [0, 1].map((k) => {
      const f = k === 0 ? Math.sin : Math.cos;
      return Math.SQRT2 * ((1 - t) * f(ends[0]) + t * f(ends[1]));
    });
    const round = [Math.sin(angle), Math.cos(angle)];
    const at = [0, 1].map((k) => (1 - out) * neck * round[k] + out * side * square[k]);
    return [at[0], 0, at[1]];
  };
  write("poncho.obj", ["A poncho: a square of 1 m with a round hole for the neck."], counts, place, null);
}

// A ribbon on edge, with a loose overhand knot. Its middle line from above, x = t^3 - 3 t, y = t^4 - 4 t^2, crosses
// itself three times (a long trefoil, after Shastri 1992); there it lies over and under itself in turns.
{
  const [unit, width, across, end, tail] = [0.07, 0.05, 5, 2.05, 0.3];
  const apart = width / (across - 1);
  const heights = [[0, 0], [0.518, 1], [1.732, -1], [1.932, 1], [end, 0.6]];
  const middle = (t) => {
    const u = Math.min(Math.abs(t), end);
    const i = Math.max(heights.findLastIndex(([at]) => at < u), 0);
    const [[from, low], [to, high]] = [heights[i], heights[i + 1]];
    const height = low + (high - low) * (0.5 - 0.5 * Math.cos((Math.PI * (u - from)) / (to - from)));
    const straight = Math.abs(t) - u;
    const x = u ** 3 - 3 * u + straight * (3 * u ** 2 - 3);
    const y = u ** 4 - 4 * u ** 2 + straight * (4 * u ** 3 - 8 * u);
    return [Math.sign(t) * x * unit, y * unit, Math.sign(t) * height * 0.8 * width];
  };
  const line = [middle(-end - tail)];
  let before = line[0];
  let walked = 0;
  for (let t = -end - tail; t <= end + tail; t += 1e-4) {
    const place = middle(t);
    walked += Math.hypot(...place.map((x, axis) => x - before[axis]));
    before = place;
    if (walked < apart) continue;
    walked -= apart;
    line.push(place);
  }
  const lines = ["# A ribbon with an overhand knot, in rows of 5 vertices, on edge along z.", "# Made by garments.mjs."];
  for (const [x, y, z] of line)
    for (let i = 0; i < across; i++) lines.push(`v ${[x, y, z + i * apart - width / 2].map(number).join(" ")}`);
  for (let row = 0; row + 1 < line.length; row++)
    for (let i = 1; i < across; i++) {
      const a = row * across + i;
      lines.push(`f ${a} ${a + across} ${a + across + 1}`, `f ${a} ${a + across + 1} ${a + 1}`);
    }
  writeFileSync(new URL("knot.obj", import.meta.url), `${lines.join("\n")}\n`);
  console.log("knot.obj", line.length, "rows,", across * line.length, "vertices");
}
