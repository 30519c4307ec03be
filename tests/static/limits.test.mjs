// The table of limits in docker/README.md: as its files have them, and fitting each other.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { root } from "./files.mjs";

const read = (file) => readFileSync(join(root, file), "utf8");

/// The numbers of the table: set-up -> limit -> value.
function table(text) {
  const [, section] = /\n## Limits that fit each other\n([^]*?)\n## /.exec(text);
  const found = {};
  let setup;
  for (const line of section.split("\n").filter((line) => /^\|(?! set-up|-)/.test(line))) {
    const [of, limit, value] = line.split("|").slice(1, 4);
    if (of.trim()) found[(setup = of.trim().replace(/\[([^\]]*)\]\([^)]*\)/g, "$1"))] = {};
    found[setup][limit.trim()] = Number(value);
  }
  return found;
}
const limits = table(read("docker/README.md"));
const alone = limits["a server alone"],
  fleet = limits["servers behind HAProxy"],
  relay = limits["a relay in Kubernetes"],
  plain = limits["a relay by default"];

/// The number that matches in a file, of which there is one.
function one(file, pattern) {
  const all = [...read(file).matchAll(new RegExp(pattern, "gm"))].map(([, value]) => Number(value));
  assert.equal(all.length, 1, `${file} has ${all.length} times ${pattern}`);
  return all[0];
}
/// An option in a list of YAML, not commented out.
const option = (file, flag) => one(file, `^ *[^#\n]*${flag}, "(\\d+)"`);

test("a server alone: viewers and addresses as compose.yaml and serve.yaml have them, sessions as the program has", () => {
  for (const file of ["docker/compose.yaml", "docker/kubernetes/serve.yaml"]) {
    assert.equal(option(file, "--max-clients"), alone.viewers);
    assert.equal(option(file, "--max-clients-per-address"), alone["viewers of an address"]);
  }
  assert.equal(alone["viewers of an address"], alone.viewers);
  assert.equal(one("server/net/limits.h", "int sessions = (\\d+);"), alone.sessions);
});

test("behind HAProxy: as its files have it, with room for all sessions and viewers on one server less", () => {
  const [cfg, readme] = ["docker/haproxy/haproxy.cfg", "docker/haproxy/README.md"];
  assert.equal(read(cfg).match(/^ {4}server \w+ /gm).length, fleet.servers);
  const flag = (name) => one(readme, `^ .*${name} (\\d+) .*\\\\$`);
  const viewers = fleet["viewers of a server, and of a session"];
  assert.equal(flag("--max-sessions"), fleet["sessions of a server"]);
  assert.equal(flag("--max-clients"), viewers);
  assert.equal(flag("--max-clients-per-address"), fleet["viewers of an address"]);
  assert.ok(fleet["viewers of an address"] <= viewers);
  const left = fleet.servers - 1;
  assert.equal(fleet["sessions watched in all"], left * fleet["sessions of a server"]);
  assert.equal(fleet["viewers in all"], left * viewers);
  const [to, server] = [fleet["connections to HAProxy"], fleet["connections of HAProxy to a server"]];
  assert.equal(one(cfg, "^    maxconn (\\d+)$"), to);
  assert.equal(one(cfg, "^    default-server .*\\bmaxconn (\\d+)$"), server);
  assert.ok(viewers < server && server <= 2 * viewers - 16, "checks and Prometheus find no connection");
  assert.equal(to, 2 * fleet["viewers in all"]);
});

test("relays: as relay.yaml and the program have them", () => {
  const file = "docker/kubernetes/relay.yaml";
  assert.equal(option(file, "--max-clients"), relay.viewers);
  assert.equal(option(file, "--max-clients-per-address"), relay["viewers of an address"]);
  assert.equal(relay["viewers of an address"], relay.viewers);
  const program = (name) => one("server/cli/relay.cpp", `limits\\.${name} = (\\d+);`);
  assert.equal(program("clients"), plain.viewers);
  assert.equal(program("clients_per_address"), plain["viewers of an address"]);
  assert.equal(program("sessions"), plain.sessions);
});

test("descriptors: as many as the program asks for", () => {
  const source = "server/cli/descriptors.cpp";
  const [own, session, client] = [
    one(source, "\\bown = (\\d+)"),
    one(source, "\\bof_session = (\\d+)"),
    one(source, "\\bconnections_of_client = (\\d+)"),
  ];
  const needed = (viewers, sessions) => client * viewers + session * sessions + own;
  assert.equal(alone.descriptors, needed(alone.viewers, alone.sessions));
  const { "viewers of a server, and of a session": viewers, "sessions of a server": sessions } = fleet;
  assert.equal(fleet["descriptors of a server"], needed(viewers, sessions));
  for (const { viewers, descriptors } of [relay, plain]) assert.equal(descriptors, needed(viewers, 0));
});
