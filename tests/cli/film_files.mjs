// Readers of what `clothlab record` writes for other programs, from the formats' specifications.

const widths = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

/// A binary glTF file: its JSON, and its arrays by accessor, an element a row.
export function readGlb(bytes) {
  const jsonBytes = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + jsonBytes).toString());
  const binary = bytes.subarray(28 + jsonBytes);
  const array = (index) => {
    const { bufferView, componentType, count, type, byteOffset = 0 } = json.accessors[index];
    const view = json.bufferViews[bufferView];
    const width = widths[type];
    const from = (view.byteOffset ?? 0) + byteOffset;
    const stride = view.byteStride ?? 4 * width;
    const read = componentType === 5126 ? "readFloatLE" : "readUInt32LE";
    return Array.from({ length: count }, (_, i) =>
      Array.from({ length: width }, (_, axis) => binary[read](from + i * stride + 4 * axis)),
    );
  };
  return { json, array };
}

const blend = (a, b, share) => a.map((x, i) => x * (1 - share) + b[i] * share);

/// The nodes of a .glb at a time: by name `places` of the mesh in the world.
export function glbAt({ json, array }, time) {
  const sampled = (node, path) => {
    const { channels = [], samplers = [] } = json.animations?.[0] ?? {};
    const channel = channels.find(({ target }) => target.node === node && target.path === path);
    if (!channel) return null;
    const { input, output } = samplers[channel.sampler];
    const times = array(input).flat();
    const flat = array(output).flat();
    const width = flat.length / times.length;
    const at = (k) => flat.slice(k * width, (k + 1) * width);
    const next = times.findIndex((each) => each >= time);
    if (next < 0) return at(times.length - 1);
    if (next === 0) return at(0);
    return blend(at(next - 1), at(next), (time - times[next - 1]) / (times[next] - times[next - 1]));
  };
  const nodes = json.nodes.map((node, i) => {
    const [primitive] = json.meshes[node.mesh].primitives;
    const places = array(primitive.attributes.POSITION);
    (sampled(i, "weights") ?? []).forEach((weight, target) => {
      if (weight === 0) return;
      const moved = array(primitive.targets[target].POSITION);
      places.forEach((place, v) => place.forEach((_, axis) => (place[axis] += weight * moved[v][axis])));
    });
    const scale = sampled(i, "scale") ?? node.scale ?? [1, 1, 1];
    const turn = sampled(i, "rotation") ?? node.rotation ?? [0, 0, 0, 1];
    const move = sampled(i, "translation") ?? node.translation ?? [0, 0, 0];
    return [node.name, { places: places.map((place) => placed(place, scale, turn, move)), primitive }];
  });
  return Object.fromEntries(nodes);
}

/// Scaled, turned by the quaternion x, y, z, w, moved.
export function placed(place, scale, [x, y, z, w], move) {
  const scaled = place.map((each, axis) => each * scale[axis]);
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const once = cross([x, y, z], scaled).map((each, axis) => each + w * scaled[axis]);
  const twice = cross([x, y, z], once);
  return scaled.map((each, axis) => each + 2 * twice[axis] + move[axis]);
}

/// A USD stage in text: {metadata, prims}, of a prim {type, name, metadata, attributes, prims}. An attribute has its
/// `value`, or `samples` by time code. Throws where the text is none of the grammar.
export function readUsda(text) {
  if (!text.startsWith("#usda 1.0\n")) throw new Error("no .usda");
  const tokens = [
    ...text.slice(9).matchAll(/\s*("(?:[^"\\]|\\.)*"|<[^>]*>|[-+]?[\d.]+(?:e[-+]?\d+)?|[\w:.]+|\S)/gy),
  ].map(([, token]) => token);
  let at = 0;
  const next = () => tokens[at++];
  const expect = (token) => {
    const found = next();
    if (found !== token) throw new Error(`${found} in place of ${token}, token ${at}: ${tokens.slice(at - 9, at + 3)}`);
  };
  const list = (end, item) => {
    const items = [];
    while (tokens[at] !== end) {
      items.push(item());
      if (tokens[at] !== end) expect(",");
    }
    next();
    return items;
  };
  function value() {
    const token = next();
    if (token === "[") return list("]", value);
    if (token === "(") return list(")", value);
    if (token.startsWith('"')) return JSON.parse(token);
    if (token.startsWith("<")) return token.slice(1, -1);
    if (token !== "" && Number.isFinite(Number(token))) return Number(token);
    throw new Error(`${token} is no value`);
  }
  function samples() {
    expect("{");
    const pairs = list("}", () => {
      const code = Number(next().replace(/:$/, ""));
      if (tokens[at] === ":") next();
      return [code, value()];
    });
    return new Map(pairs);
  }
  function metadata() {
    const found = {};
    if (tokens[at] !== "(") return found;
    next();
    while (tokens[at] !== ")") {
      const name = tokens[at] === "prepend" ? (next(), next()) : next();
      expect("=");
      found[name] = value();
    }
    next();
    return found;
  }
  function attribute(prim) {
    const words = [next()];
    while (!["=", "(", "}"].includes(tokens[at]) && words.length < 6) {
      words.push(next());
      if (words.at(-1) === "[") next(), words.splice(-2, 2, `${words.at(-2)}[]`);
      if (/^[\w:]+(?:\.timeSamples|\.connect)?$/.test(words.at(-1)) && words.length > 1 && !isType(words)) break;
    }
    const [name, kind = "value"] = words.at(-1).split(".");
    const known = (prim.attributes[name] ??= {});
    if (tokens[at] === "=") {
      next();
      if (kind === "timeSamples") known.samples = samples();
      else known[kind] = value();
    }
    Object.assign(known, metadata());
  }
  const isType = (words) => ["custom", "uniform"].includes(words.at(-2)) || words.at(-1).endsWith("[]");
  function prim() {
    expect("def");
    const made = { type: next(), name: value(), attributes: {}, prims: [] };
    made.metadata = metadata();
    expect("{");
    while (tokens[at] !== "}") tokens[at] === "def" ? made.prims.push(prim()) : attribute(made);
    next();
    return made;
  }
  const stage = { metadata: metadata(), prims: [] };
  while (at < tokens.length) stage.prims.push(prim());
  return stage;
}

/// The value of an attribute at a time code that has a sample, or at any if it has none.
export const valueAt = ({ value, samples }, code) => (samples ? samples.get(code) : value);

/// The vertices and corners of an .obj file, as they are written.
export function readObj(text) {
  const lines = (key) => text.split("\n").filter((line) => line.startsWith(`${key} `));
  const numbers = (line) => line.split(" ").slice(1).map(Number);
  return {
    places: lines("v").map(numbers),
    texture: lines("vt").map(numbers),
    triangles: lines("f").map((line) =>
      line
        .split(" ")
        .slice(1)
        .map((corner) => Number.parseInt(corner, 10) - 1),
    ),
  };
}
