#!/usr/bin/env node
// The inputs of a fuzz target in one file, tests/fuzz/corpus/TARGET.txt, and as the folder of files that libFuzzer
// reads and writes:
//   node tests/fuzz/corpus.mjs unpack TARGET FOLDER        writes each input as a file of FOLDER
//   node tests/fuzz/corpus.mjs pack FOLDER TARGET          makes the target's file of all files of FOLDER
//   node tests/fuzz/corpus.mjs add TARGET FILE [NAME]      adds an input, or replaces it; NAME: else the file's
// A line is the input's name, a tab, and its bytes: printable ASCII as it is, but \\ for a backslash; \n; \t; any other
// byte as \x and two digits. Lines are sorted by name, so that the same inputs always make the same file. replay.cpp
// reads it, too.
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { fileURLToPath } from "node:url";

const named = { "\\": "\\\\", "\n": "\\n", "\t": "\\t" };

export const escaped = (bytes) =>
  bytes
    .toString("latin1")
    .replace(/[^ -[\]-~]/g, (byte) => named[byte] ?? `\\x${byte.charCodeAt(0).toString(16).padStart(2, "0")}`);

export const unescaped = (text) =>
  Buffer.from(
    text.replace(/\\(?:x([0-9a-f]{2})|(.?))/g, (whole, digits, letter) => {
      if (digits) return String.fromCharCode(Number.parseInt(digits, 16));
      const byte = { n: "\n", t: "\t", "\\": "\\" }[letter];
      if (!byte) throw new Error(`${whole} is none of \\\\, \\n, \\t and \\x with two digits`);
      return byte;
    }),
    "latin1",
  );

/// The inputs by their names.
export function readPacked(text) {
  const inputs = new Map();
  for (const line of text.split("\n").slice(0, -1)) {
    const [, name, bytes] = /^([\w.-]+)\t(.*)$/.exec(line) ?? [];
    if (!name) throw new Error(`no name and tab: ${line.slice(0, 60)}`);
    if (inputs.has(name)) throw new Error(`${name} is there twice`);
    inputs.set(name, unescaped(bytes));
  }
  return inputs;
}

export const packed = (inputs) =>
  [...inputs.keys()]
    .sort()
    .map((name) => `${name}\t${escaped(inputs.get(name))}\n`)
    .join("");

export const fileOf = (target) => fileURLToPath(new URL(`corpus/${target}.txt`, import.meta.url));
const inputsOf = (target) => readPacked(readFileSync(fileOf(target), "latin1"));

const commands = {
  unpack(target, folder) {
    mkdirSync(folder, { recursive: true });
    for (const [name, bytes] of inputsOf(target)) writeFileSync(join(folder, name), bytes);
  },
  pack(folder, target) {
    const inputs = new Map(readdirSync(folder).map((name) => [name, readFileSync(join(folder, name))]));
    writeFileSync(fileOf(target), packed(inputs));
  },
  add(target, file, name = basename(file)) {
    writeFileSync(fileOf(target), packed(inputsOf(target).set(name, readFileSync(file))));
  },
};

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [command, ...rest] = process.argv.slice(2);
  if (!commands[command] || rest.length < 2) {
    console.error("usage: corpus.mjs unpack TARGET FOLDER | pack FOLDER TARGET | add TARGET FILE [NAME]");
    process.exit(2);
  }
  commands[command](...rest);
}
