// Files that documents and comments name exist, and the top README stays short.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join, normalize } from "node:path";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const read = (file) => readFileSync(join(root, file), "utf8");
const documents = files.filter((file) => file.endsWith(".md"));

/// The anchor that GitHub makes for a heading.
const anchors = (text) =>
  [...text.matchAll(/^#+ (.*)$/gm)].map(([, title]) =>
    title
      .toLowerCase()
      .replace(/[^\p{Letter}\p{Number}\s_-]/gu, "")
      .trim()
      .replace(/\s/g, "-"),
  );

test("the top README has at most 150 lines", () => {
  assert.ok(read("README.md").split("\n").length <= 151);
});

test("every link of a document leads to a file, and to a heading in it", () => {
  const wrong = [];
  for (const document of documents) {
    const text = read(document).replace(/```[^]*?```/g, "");
    for (const [, link] of text.matchAll(/\]\(([^)\s]+)\)/g)) {
      if (/^[a-z]+:/.test(link)) continue;
      const [path, anchor] = link.split("#");
      const target = path === "" ? document : normalize(join(dirname(document), path)).replace(/\/$/, "");
      const known = files.includes(target) || files.some((file) => file.startsWith(`${target}/`));
      if (!known) wrong.push(`${document}: ${link}`);
      else if (anchor && !anchors(read(target)).includes(anchor))
        wrong.push(`${document}: ${link} has no such heading`);
    }
  }
  assert.deepEqual(wrong, []);
});

test("the number of methods for operators that a document tells is that of the table", () => {
  const count = [...read("server/net/methods.cpp").matchAll(/Method\{"[\w.]+", For::operators,/g)].length;
  const told = documents.flatMap((file) => [...read(file).matchAll(/(\d+) methods for operators/g)]);
  assert.ok(told.length > 0);
  assert.deepEqual(
    told.map(([, number]) => Number(number)),
    told.map(() => count),
  );
});

/// Matches a path with a folder, or a document's bare name, in a comment or a document; not files that a program makes.
const named =
  /(?<![\w/.<"$~{}-])((?:[\w.-]+\/)+[\w.-]+\.(?:md|h|cpp|glsl|comp|vert|geom|frag|ts|mjs|json|yaml|css|html|sh)|[\w-]+\.md)(?![\w/*])/g;
const comments = (file, text) =>
  file.endsWith(".md")
    ? text.replace(/```[^]*?```/g, "")
    : /\.(?:sh|yaml)$|\/run$|CMakeLists/.test(file)
      ? text
          .split("\n")
          .filter((line) => /^\s*#/.test(line))
          .join("\n")
      : [...text.matchAll(/(?:^|[^:"'])\/\/(.*)$/gm)].map(([, comment]) => comment).join("\n");

test("every file that a comment or a document names is there", () => {
  const wrong = [];
  for (const file of files) {
    if (!/\.(?:md|h|cpp|glsl|comp|vert|geom|frag|ts|mjs|yaml|sh)$|\/run$|CMakeLists/.test(file)) continue;
    for (const [, path] of comments(file, read(file)).matchAll(named)) {
      if (/[A-Z]{4,}/.test(path.replace(/README|CMakeLists/g, ""))) continue; // a placeholder: step-MACHINE.json
      // From the root, from the file's folder, or from a folder above it.
      const places = [path];
      for (let folder = dirname(file); folder !== "."; folder = dirname(folder)) places.push(join(folder, path));
      if (!places.some((place) => existsSync(join(root, place)))) wrong.push(`${file}: ${path}`);
    }
  }
  assert.deepEqual(wrong, []);
});
