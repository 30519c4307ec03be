// A garment and a body for it as .obj files: numbers in millimetres unless `unit` says otherwise.

const face = (...corners) => `f ${corners.join(" ")}\n`;

/// A tube about the y axis, open at both ends: `radius` along x, three quarters of that along z [m].
export function tube({ radius = 0.24, from = 0.9, to = 1.45, around = 40, rows = 24, unit = 1000, first = 1 } = {}) {
  let text = "o shirt\n";
  for (let row = 0; row <= rows; ++row)
    for (let i = 0; i < around; ++i) {
      const angle = (2 * Math.PI * i) / around;
      const place = [radius * Math.cos(angle), from + ((to - from) * row) / rows, 0.75 * radius * Math.sin(angle)];
      text += `v ${place.map((value) => (unit * value).toFixed(3)).join(" ")}\n`;
    }
  const vertex = (row, i) => first + row * around + (i % around);
  for (let row = 0; row < rows; ++row)
    for (let i = 0; i < around; ++i)
      text += face(vertex(row, i), vertex(row + 1, i), vertex(row + 1, i + 1), vertex(row, i + 1));
  return text;
}

/// A closed body on the ground: an ellipsoid of that height and half-widths [m].
export function figure({ height = 1.7, wide = 0.2, deep = 0.14, around = 24, rows = 30, unit = 1000, first = 1 } = {}) {
  const at = (x, y, z) => `v ${[x, y, z].map((value) => (unit * value).toFixed(3)).join(" ")}\n`;
  let text = `o figure\n${at(0, 0, 0)}`;
  for (let row = 1; row < rows; ++row)
    for (let i = 0; i < around; ++i) {
      const [up, angle] = [(Math.PI * row) / rows, (2 * Math.PI * i) / around];
      const out = Math.sin(up);
      text += at(wide * out * Math.cos(angle), height * (0.5 - 0.5 * Math.cos(up)), deep * out * Math.sin(angle));
    }
  text += at(0, height, 0);
  const vertex = (row, i) => first + 1 + (row - 1) * around + (i % around);
  const top = first + 1 + (rows - 1) * around;
  for (let i = 0; i < around; ++i) {
    text += face(first, vertex(1, i), vertex(1, i + 1)) + face(top, vertex(rows - 1, i + 1), vertex(rows - 1, i));
    for (let row = 1; row < rows - 1; ++row)
      text += face(vertex(row, i), vertex(row + 1, i), vertex(row + 1, i + 1), vertex(row, i + 1));
  }
  return text;
}

/// Both in one file, as two objects.
export function dressed() {
  const shirt = tube();
  return shirt + figure({ first: 1 + shirt.match(/^v /gm).length });
}
