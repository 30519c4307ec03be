// Whether a page shows all of the cloth: a function that runs in the page.

/// How much of the frame's vertices and spheres lies outside the window or behind a card: number of points, and the
/// farthest. Projected here with the camera's matrices alone.
export const hiddenPoints = (margin) => {
  const {
    stage,
    lastFrame: { header, buffer },
    document: scene,
  } = window.clothlab;
  const words = new Uint16Array(buffer, 64, header.vertexCount * 4);
  const points = Array.from({ length: header.vertexCount }, (_, i) =>
    [0, 1, 2].map((axis) => header.boxMinimum[axis] + (header.boxExtent[axis] * words[4 * i + axis]) / 65535),
  );
  const { camera } = stage;
  camera.updateMatrixWorld();
  const times = (m, [x, y, z, w]) =>
    [0, 1, 2, 3].map((row) => m[row] * x + m[row + 4] * y + m[row + 8] * z + m[row + 12] * w);
  const cards = [...document.querySelectorAll(".card")]
    .filter((card) => card.checkVisibility({ visibilityProperty: true }))
    .map((card) => [card.id, card.getBoundingClientRect()]);
  let hidden = 0,
    worst = 0,
    where = "",
    left = 1e9,
    right = -1e9,
    top = 1e9,
    bottom = -1e9;
  for (const point of points) {
    const eye = times(camera.matrixWorldInverse.elements, [...point, 1]);
    const clip = times(camera.projectionMatrix.elements, eye);
    const x = ((clip[0] / clip[3] + 1) / 2) * innerWidth,
      y = ((1 - clip[1] / clip[3]) / 2) * innerHeight;
    (left = Math.min(left, x)), (right = Math.max(right, x)), (top = Math.min(top, y)), (bottom = Math.max(bottom, y));
    const out = [
      ["the window", Math.max(-x, x - innerWidth, -y, y - innerHeight)],
      ...cards.map(([id, box]) => [id, Math.min(x - box.left, box.right - x, y - box.top, box.bottom - y)]),
    ];
    const [by, depth] = out.reduce((a, b) => (b[1] > a[1] ? b : a));
    if (depth <= -margin) continue;
    hidden++;
    if (where === "" || depth > worst) (worst = depth), (where = by);
  }
  // No card may stick out of the window, either.
  const cut = cards
    .filter(([, box]) => box.left < 0 || box.right > innerWidth + 0.5)
    .map(([id]) => id)
    .join();
  return {
    cut,
    hidden,
    of: points.length,
    worst: Math.round(worst),
    where,
    scene: scene.name,
    time: header.time,
    box: [left, top, right, bottom].map(Math.round),
    fill: Math.max((right - left) / innerWidth, (bottom - top) / innerHeight),
  };
};
