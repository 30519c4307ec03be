// A square sheet of two panels, as a file has it whose texture is cut along a seam: the seam's vertices are there
// twice, and one vertex is part of no face. It hangs in the plane z = 0, its upper edge at the height of 1 m.
const firstOfObj = 1; // .obj files count from 1

export function seamed(columns = 13, side = 0.8) {
  const middle = (columns - 1) / 2;
  const [places, texture, triangles] = [[[5, 5, 5]], [[0, 0]], []];
  const cells = [null]; // of each vertex of the file its column and row; null: of no face
  for (const [from, to] of [
    [0, middle],
    [middle, columns - 1],
  ]) {
    const [first, wide] = [places.length, to - from + 1];
    for (let row = 0; row < columns; ++row)
      for (let column = from; column <= to; ++column) {
        places.push([(column / (columns - 1) - 0.5) * side, 1 - (row / (columns - 1)) * side, 0]);
        texture.push([(column - from) / (columns - 1), row / (columns - 1)]);
        cells.push([column, row]);
      }
    for (let row = 0; row < columns - 1; ++row)
      for (let i = 0; i < wide - 1; ++i) {
        const at = first + row * wide + i;
        triangles.push([at, at + wide, at + wide + 1], [at, at + wide + 1, at + 1]);
      }
  }
  // Frames have each place once, in the order of the file.
  const known = new Map();
  const inFrames = cells.map((cell) => {
    if (!cell) return 0xffffffff;
    if (!known.has(`${cell}`)) known.set(`${cell}`, known.size);
    return known.get(`${cell}`);
  });
  return {
    places, ///< [vertices of the file]
    inFrames, ///< [vertices of the file] counted from the cloth's first; 0xffffffff: in no frame
    vertices: known.size, ///< in frames
    /// The first vertex of the file in this column and row.
    numberAt: (column, row) => cells.findIndex((cell) => cell?.[0] === column && cell[1] === row),
    obj: [
      ...places.map((place) => `v ${place.join(" ")}`),
      ...triangles.map((corners) => `f ${corners.map((corner) => corner + firstOfObj).join(" ")}`),
    ].join("\n"),
    gltf: JSON.stringify(gltf(places, texture, triangles)),
  };
}

function gltf(places, texture, triangles) {
  const arrays = [new Float32Array(places.flat()), new Float32Array(texture.flat()), new Uint32Array(triangles.flat())];
  const bytes = Buffer.concat(arrays.map(({ buffer }) => Buffer.from(buffer)));
  let end = 0;
  const bufferViews = arrays.map(({ byteLength }) => {
    const view = { buffer: 0, byteOffset: end, byteLength };
    end += byteLength;
    return view;
  });
  const of = (choose) => [0, 1, 2].map((axis) => choose(...places.map((place) => Math.fround(place[axis]))));
  const [float, uint] = [5126, 5125];
  return {
    asset: { version: "2.0" },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2 }] }],
    accessors: [
      { bufferView: 0, componentType: float, count: places.length, type: "VEC3", min: of(Math.min), max: of(Math.max) },
      { bufferView: 1, componentType: float, count: places.length, type: "VEC2" },
      { bufferView: 2, componentType: uint, count: 3 * triangles.length, type: "SCALAR" },
    ],
    bufferViews,
    buffers: [{ byteLength: end, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
  };
}
