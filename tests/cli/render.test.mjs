// `clothlab render`: the picture is a PNG of the size asked for, and shows the scene.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { decode, region } from "./png.mjs";
import { clothlab, folder, program } from "./program.mjs";

function render(name, ...args) {
  const { status, stderr } = clothlab(["render", ...args, "--out", name]);
  assert.equal(status, 0, stderr);
  return decode(readFileSync(join(folder, name)), args.includes("--clear"));
}

const isRed = ([r, g, b]) => r > 1.6 * g && r > 1.6 * b;

test("a preset's picture for the page is drawn, and where that is impossible the build says so and goes on", () => {
  const script = fileURLToPath(new URL("../../web/pictures.cmake", import.meta.url));
  const made = (program, preset, out) =>
    spawnSync(
      "cmake",
      [`-DPROGRAM=${program}`, `-DPRESET=${preset}`, "-DTIME=0.1", `-DOUT=${join(folder, out)}`, "-P", script],
      { encoding: "utf8" },
    );
  for (const preset of ["seed", "blowup"]) {
    assert.equal(made(resolve(program), preset, `${preset}.png`).status, 0);
    const { width, height } = decode(readFileSync(join(folder, `${preset}.png`)));
    assert.deepEqual([width, height], [320, 200]);
  }
  const none = made("/bin/false", "seed", "none.png");
  assert.equal(none.status, 0);
  assert.match(none.stdout, /no picture of the preset seed/);
  // Each moment is that of a preset.
  const names = readdirSync(fileURLToPath(new URL("../../server/scene/presets", import.meta.url)));
  for (const [, name] of readFileSync(script, "utf8").matchAll(/^set\(moment_(\S+)/gm))
    assert.ok(names.includes(`${name}.json`), name);
});

test("the seed scene's red cloth fills a good part of the picture and touches no edge", () => {
  const image = render("seed.png", "seed", "--time", "0.5", "--size", "320x180");
  assert.deepEqual([image.width, image.height], [320, 180]);
  const cloth = region(image, isRed);
  assert.ok(cloth.count > 0.05 * 320 * 180, `${cloth.count} pixels`);
  assert.ok(cloth.left > 0 && cloth.right < 319 && cloth.top > 0 && cloth.bottom < 179);
});

test("a portrait picture is framed as well", () => {
  const cloth = region(render("tall.png", "seed", "--time", "0.5", "--size", "120x240"), isRed);
  assert.ok(cloth.count > 0.05 * 120 * 240);
  assert.ok(cloth.left > 0 && cloth.right < 119 && cloth.top > 0 && cloth.bottom < 239);
});

test("both sides of the cloth are drawn: turned over, it covers the same pixels", () => {
  const plain = ["seed", "--time", "0", "--size", "160x90", "--set", "/colliders=[]", "--set", "/cloths/0/pins=[]"];
  const centered = [...plain, "--set", "/cloths/0/transform/translate=[0,0,-0.5]"];
  const turned = [
    ...plain,
    "--set",
    "/cloths/0/transform/translate=[0,0,0.5]",
    "--set",
    "/cloths/0/transform/rotate=[180,0,0]",
  ];
  const front = region(render("front.png", ...centered), isRed),
    back = region(render("back.png", ...turned), isRed);
  assert.ok(front.count > 500);
  assert.ok(Math.abs(front.count - back.count) < 0.05 * front.count, `${front.count} and ${back.count} pixels`);
});

test("a capsule, a box and a mesh are drawn where they are, and are shaded by their sides", () => {
  const scene = (...colliders) => [
    ...["seed", "--time", "0", "--size", "240x180", "--set", `/colliders=${JSON.stringify(colliders)}`],
    ...["--set", "/cloths/0/pins=[]", "--set", "/cloths/0/transform/translate=[0,1,-0.5]"],
  ];
  const far = { plane: { point: [0, -9, 0], normal: [0, 1, 0] } };
  const bodies = [
    { capsule: { a: [-0.4, 0, -0.4], b: [0.3, 0.3, -0.4], radius: 0.12 } },
    { box: { center: [0, 0, 0.4], half: [0.35, 0.12, 0.2], rotate: [0, 30, 10] } },
    { mesh: { obj: "presets/torso.obj" }, transform: { translate: [0, -1.2, 0.4], rotate: [0, 40, 0] } },
  ];
  for (const [n, body] of bodies.entries()) {
    const other =
      "capsule" in body
        ? { capsule: { ...body.capsule, radius: 1e-6 } }
        : "box" in body
          ? { box: { ...body.box, half: [1e-6, 1e-6, 1e-6] } }
          : { ...body, transform: { ...body.transform, translate: [0, 0, 0.4], scale: 1e-6 } };
    // A ball as large as the body's surroundings frames both pictures alike.
    const frame = { sphere: { center: [0, -0.6, 0], radius: 0.3 } };
    const with_ = render(`body-${n}.png`, ...scene(far, frame, body)),
      without = render(`none-${n}.png`, ...scene(far, frame, other));
    const shades = new Set();
    let changed = 0;
    for (let y = 0; y < 180; ++y)
      for (let x = 0; x < 240; ++x) {
        const [a, b] = [with_.at(x, y), without.at(x, y)];
        if (Math.max(...a.map((value, channel) => Math.abs(value - b[channel]))) < 12) continue;
        ++changed;
        shades.add(a[1] >> 3);
      }
    assert.ok(changed > 400, `${changed} pixels show the ${Object.keys(body)[0]}`);
    assert.ok(shades.size >= 2, `${shades.size} shades`);
  }
});

test("the colour is the scene's", () => {
  const image = render("blue.png", "seed", "--time", "0", "--size", "160x90", "--set", "/cloths/0/color=#2040d0");
  assert.equal(region(image, isRed).count, 0);
  assert.ok(region(image, ([r, g, b]) => b > 1.5 * r && b > 1.5 * g).count > 500);
});

// A cloth that lies at y = 1 m, a metre wide, and far from it a ball that makes it small in a picture of both.
const apart = [
  ...["seed", "--time", "0", "--set", "/cloths/0/pins=[]", "--set", "/cloths/0/name=sheet"],
  ...["--set", '/colliders=[{"name": "far", "sphere": {"center": [6, 0, 0], "radius": 1}}]'],
];
const [width, height] = [240, 160];
const small = ["--size", `${width}x${height}`];
const filled = 1 / 1.08; // of the picture, in its tighter direction: the rest is margin

/** How wide, how high and where a region is in its picture: 1 is all of it, 0 its middle. */
function placeIn(image, { left, right, top, bottom }) {
  return {
    wide: (right + 1 - left) / image.width,
    high: (bottom + 1 - top) / image.height,
    aside: (left + right + 1) / image.width - 1,
    below: (top + bottom + 1) / image.height - 1,
  };
}

/** In the middle, and as large as the margin allows, but for pixels at each side that it may only touch. */
function assertFills({ wide, high, aside, below }, what, touched = 1) {
  const found = `${what}: ${JSON.stringify({ wide, high, aside, below })}`;
  assert.ok(Math.abs(aside) <= 2 / width && Math.abs(below) <= 2 / height, found);
  assert.ok(Math.abs(Math.max(wide, high) - filled) <= (2 * touched) / height, found);
}

test("the cloth or body that --camera names fills the picture, in its middle", () => {
  const both = region(render("both.png", ...apart, ...small), isRed);
  const image = render("sheet.png", ...apart, ...small, "--camera", "sheet");
  const sheet = region(image, isRed);
  assert.ok(sheet.count > 9 * both.count, JSON.stringify({ both, sheet }));
  assertFills(placeIn(image, sheet), "sheet");
  const far = render("far.png", ...apart, ...small, "--camera", "far");
  assert.equal(region(far, isRed).count, 0, "the cloth is out of the picture");
  const [corner, middle] = [far.at(3, 3), far.at(width / 2, height / 2)];
  assert.ok(Math.max(...corner.map((value, i) => Math.abs(value - middle[i]))) > 20, `${corner} and ${middle}`);
});

test("where the camera stands, looks to, and its angle are as --camera says, and the rest is chosen", () => {
  const cloth = (camera) => {
    const image = render("seen.png", ...apart, ...small, "--camera", camera);
    return placeIn(image, region(image, isRed));
  };
  const above = cloth("sheet;from=0,5,0.5");
  assertFills(above, "from above");
  assert.ok(Math.abs(above.wide * width - above.high * height) <= 2, `a square: ${JSON.stringify(above)}`);
  assertFills(cloth("from=1.5,5,-1;sheet"), "from aside", 2); // the tips of corners cover less than a pixel
  // 2 m at a distance of 4 m from the lower to the upper edge: the sheet's metre is half of that.
  const angle = (360 / Math.PI) * Math.atan(1 / 4);
  const half = cloth(`from=0,5,0.5;to=0,1,0.5;angle=${angle}`);
  assert.ok(Math.abs(half.high - 0.5) <= 2 / height, JSON.stringify(half));
  const moved = cloth(`from=0,5,0.5;to=0,1,0;angle=${angle}`);
  assert.ok(Math.abs(moved.below - half.below) > 0.25, JSON.stringify({ half, moved }));
});

test("a camera of nothing, or that cannot be, is refused with what there is", () => {
  const refused = (camera, message) => {
    const { status, stderr } = clothlab(["render", ...apart, "--out", "no.png", "--camera", camera]);
    assert.equal(status, 2, `${camera}: ${stderr}`);
    assert.match(stderr, message);
  };
  for (const nobody of ["nobody", "sheet;far", "at=1,2,3", ""])
    refused(nobody, new RegExp(`--camera: "${nobody}"; .*\\("sheet", "far"\\), or from=X,Y,Z`));
  for (const place of ["from=1,2", "from=1,2,3,", "to=1,x,3", "to=1,2,1e7", "to=1,2,nan"])
    refused(place, new RegExp(`--camera: "${place}"; three numbers`));
  for (const angle of ["angle=0", "angle=x", "angle=151", "angle=1,2"])
    refused(angle, new RegExp(`--camera: "${angle}"; .*at most 150 degrees`));
  refused("from=1,2,3;to=1,2,3", /two places for from and to/);
});

test("sizes have names", () => {
  const square = render("square.png", ...apart, "--size", "square");
  assert.deepEqual([square.width, square.height], [1080, 1080]);
  const { status, stderr } = clothlab(["render", ...apart, "--out", "no.png", "--size", "2K"]);
  assert.equal(status, 2);
  assert.match(stderr, /--size: 2K; .*1080p, 4K or square/);
});

test("whatever a body's kind, it is exactly in the middle of its picture", () => {
  const bodies = {
    sphere: { sphere: { center: [50, 1, 0], radius: 0.7 } },
    capsule: { capsule: { a: [50, 0, 0], b: [51, 0.5, 2], radius: 0.2 } },
    box: { box: { center: [50, 0, 0], half: [0.1, 0.8, 0.4], rotate: [10, 50, 30] } },
    mesh: { mesh: { obj: "presets/torso.obj" }, transform: { translate: [50, 0, 0], rotate: [0, 40, 0] } },
  };
  const scene = ["seed", "--time", "0", "--set", "/cloths/0/pins=[]", ...small, "--clear"];
  for (const [name, body] of Object.entries(bodies))
    for (const camera of [name, `${name};from=54,3,-4`]) {
      const set = `/colliders=${JSON.stringify([{ name, ...body }])}`;
      const image = render("body.png", ...scene, "--set", set, "--camera", camera);
      const seen = region(image, ([, , , opacity]) => opacity > 0);
      assertFills(placeIn(image, seen), camera);
    }
});

test("a clear picture laid on the background is the picture with it, and beside the scene it is transparent", () => {
  const args = ["seed", "--time", "0", "--set", "/cloths/0/pins=[]", "--set", "/colliders=[]", ...small];
  const [plain, clear] = [render("plain.png", ...args), render("clear.png", ...args, "--clear")];
  const seen = { none: 0, all: 0, part: 0 };
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const [pixel, shown] = [clear.at(x, y), plain.at(x, y)];
      const opacity = pixel[3];
      seen[opacity === 0 ? "none" : opacity === 255 ? "all" : "part"]++;
      const behind = plain.at(0, y); // the background is as bright along a row
      for (let part = 0; part < 3; ++part) {
        const laid = (pixel[part] * opacity + behind[part] * (255 - opacity)) / 255;
        // Rounded: the colour, the opacity, and in the plain picture the mean of the samples and their background.
        assert.ok(Math.abs(laid - shown[part]) <= 3, `at ${x}, ${y}: ${pixel} laid on ${behind} is no ${shown}`);
      }
    }
  assert.equal(clear.at(0, 0)[3], 0);
  assert.ok(
    seen.none > 0.3 * width * height && seen.all > 0.1 * width * height && seen.part > 50,
    JSON.stringify(seen),
  );
});

test("of a plane a clear picture has the shadow on it, as dark as it is on the plane", () => {
  // A sheet a metre above a floor, both seen from above: beside the sheet's own place is its shadow.
  const floor = { name: "floor", plane: { point: [0, 0, 0], normal: [0, 1, 0] } };
  const scene = ["seed", "--time", "0", "--set", "/cloths/0/pins=[]", "--set", `/colliders=[${JSON.stringify(floor)}]`];
  const args = [...scene, ...small, "--camera", "from=0,8,0.6;to=0,0.5,0.5;angle=25"];
  const [plain, clear] = [render("floor.png", ...args), render("shadow.png", ...args, "--clear")];
  const isShadow = ([r, g, b, opacity]) => r + g + b === 0 && opacity > 60;
  const shadow = region(clear, isShadow);
  assert.ok(shadow.count > 300, JSON.stringify(shadow));
  assert.ok(clear.at(0, 0)[3] < 4, "the lit floor leaves nothing");
  const lit = plain.at(shadow.right + 6, Math.round((shadow.top + shadow.bottom) / 2))[1]; // beside the shadow
  let worst = 0;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const pixel = clear.at(x, y);
      if (!isShadow(pixel)) continue;
      worst = Math.max(worst, Math.abs(lit * (1 - pixel[3] / 255) - plain.at(x, y)[1]));
    }
  assert.ok(worst <= 2, `${worst} of 255: rounding of the opacity and of both colours`);
});
