// Writes torso.obj beside it: a dressmaker's dummy, a closed surface of rings around an upright axis, in metres.
// `node server/scene/presets/bodies.mjs`
import { writeFileSync } from "node:fs";

const sectors = 40;
const rings = 36;

/// The dummy's sections from below: height, half of the width, half of the depth, and how far forward the middle is.
const sections = [
  [0.8, 0.13, 0.09, 0],
  [0.83, 0.165, 0.112, -0.008],
  [0.92, 0.18, 0.125, -0.012],
  [1.0, 0.16, 0.11, -0.004],
  [1.09, 0.132, 0.092, 0.004],
  [1.17, 0.143, 0.102, 0.006],
  [1.26, 0.165, 0.124, 0.014],
  [1.34, 0.176, 0.112, 0.006],
  [1.4, 0.17, 0.088, -0.004],
  [1.44, 0.12, 0.068, -0.008],
  [1.465, 0.068, 0.058, -0.006],
  [1.5, 0.056, 0.055, 0],
  [1.55, 0.052, 0.052, 0.004],
];

/// A section at a share of the height, on a curve through all of them (Catmull-Rom).
function section(share) {
  const at = share * (sections.length - 1);
  const first = Math.min(Math.floor(at), sections.length - 2);
  const t = at - first;
  const of = (i) => sections[Math.max(0, Math.min(sections.length - 1, i))];
  return of(first).map((b, k) => {
    const [a, c, d] = [of(first - 1)[k], of(first + 1)[k], of(first + 2)[k]];
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
  });
}

const number = (x) => String(Number(x.toFixed(5)) + 0); // + 0: no "-0"
const lines = ["# A dressmaker's dummy, closed, its front to z > 0.", "# Made by bodies.mjs."];
const point = (...x) => lines.push(`v ${x.map(number).join(" ")}`);
for (let ring = 0; ring < rings; ring++) {
  const [y, width, depth, forward] = section(ring / (rings - 1));
  for (let i = 0; i < sectors; i++) {
    const angle = (2 * Math.PI * i) / sectors;
    // Between an ellipse and a box, as bodies are.
    const round = (x) => Math.sign(x) * Math.abs(x) ** 0.85;
    point(width * round(Math.cos(angle)), y, forward + depth * round(Math.sin(angle)));
  }
}
const [bottom, top] = [sections[0], sections.at(-1)];
point(0, bottom[0] - 0.02, bottom[3]);
point(0, top[0] + 0.015, top[3]);
const vertex = (ring, i) => ring * sectors + (i % sectors) + 1;
for (let i = 0; i < sectors; i++) {
  lines.push(`f ${rings * sectors + 1} ${vertex(0, i)} ${vertex(0, i + 1)}`);
  lines.push(`f ${rings * sectors + 2} ${vertex(rings - 1, i + 1)} ${vertex(rings - 1, i)}`);
  for (let ring = 0; ring + 1 < rings; ring++)
    lines.push(
      `f ${vertex(ring, i)} ${vertex(ring + 1, i)} ${vertex(ring + 1, i + 1)}`,
      `f ${vertex(ring, i)} ${vertex(ring + 1, i + 1)} ${vertex(ring, i + 1)}`,
    );
}
writeFileSync(new URL("torso.obj", import.meta.url), `${lines.join("\n")}\n`);
