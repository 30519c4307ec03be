// docker/prometheus and docker/grafana: what Prometheus accepts, each alert on both sides of its limit, and no metric
// that the server does not export.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { root } from "./files.mjs";

const installed = existsSync(join(root, "tests/node_modules/yaml"));
const skip = !installed && "tests/node_modules is not installed: tests/run does it";
const no_promtool =
  spawnSync("promtool", ["--version"]).status !== 0 && "promtool is not installed: Debian's package prometheus has it";
const { parse } = installed ? createRequire(import.meta.url)("yaml") : {};
const read = (file) => readFileSync(join(root, file), "utf8");

/// Runs promtool in a copy of docker/prometheus with a token, and `change` made to it.
function promtool(args, change = () => {}) {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-fleet-"));
  try {
    cpSync(join(root, "docker/prometheus"), folder, { recursive: true });
    writeFileSync(join(folder, "token"), "a token");
    change(folder);
    const { status, stdout, stderr } = spawnSync("promtool", args, { cwd: folder, encoding: "utf8" });
    return { status, said: stdout + stderr };
  } finally {
    rmSync(folder, { recursive: true });
  }
}
const replace = (file, from, to) => (folder) => {
  const text = readFileSync(join(folder, file), "utf8");
  assert.ok(text.includes(from), `${file}: ${from}`);
  writeFileSync(join(folder, file), text.replace(from, to));
};

const config = ["check", "config", "prometheus.yml"];
const rules = ["check", "rules", "alerts.yml"];
const limits = ["test", "rules", "alerts_test.yml"];
for (const [what, args] of [
  ["the configuration", config],
  ["the alerts", rules],
  ["each alert's two sides", limits],
])
  test(`promtool accepts ${what}`, { skip: no_promtool }, () => {
    const { status, said } = promtool(args);
    assert.equal(status, 0, said);
    assert.match(said, /SUCCESS/);
  });

for (const [what, args, change] of [
  ["a misspelt option", config, replace("prometheus.yml", "scrape_timeout", "scrape_timeot")],
  ["a token that is not there", config, (folder) => rmSync(join(folder, "token"))],
  ["an expression that is none", rules, replace("alerts.yml", "== 0", "== == 0")],
  ["a limit that is higher", limits, replace("alerts.yml", "> 0.05", "> 0.08")],
  [
    "a limit that is lower",
    limits,
    replace("alerts.yml", 'waiting{job="clothlab"} >= 8', 'waiting{job="clothlab"} >= 7'),
  ],
  ["a shorter wait", limits, replace("alerts.yml", "for: 45m", "for: 30m")],
  ["another job", limits, replace("alerts.yml", 'up{job="clothlab"}', 'up{job="cloth"}')],
])
  test(`promtool refuses ${what}`, { skip: no_promtool }, () => {
    const { status, said } = promtool(args, change);
    assert.notEqual(status, 0, said);
  });

/// The metrics that server/net/metrics.cpp writes: name -> type.
function exported(source) {
  const found = [...source.matchAll(/\b(?:count|family|head)\(\s*(?:out,\s*)?"(\w+)",\s*"(\w+)",/g)];
  return new Map(found.map(([, name, type]) => [name, type]));
}
const metrics = exported(read("server/net/metrics.cpp"));
/// The names that Prometheus stores: of a histogram three.
const stored = new Set(
  [...metrics].flatMap(([name, type]) =>
    type === "histogram" ? ["_bucket", "_sum", "_count"].map((end) => name + end) : [name],
  ),
);
/// Those that Prometheus makes itself.
const of_prometheus = ["up", "ALERTS"];

test("the metrics that the server exports are read from its source", () => {
  const source = read("server/net/metrics.cpp");
  const literals = new Set(source.match(/(?<=")(?:clothlab|process)_\w+(?=")/g));
  assert.deepEqual([...metrics.keys()].sort(), [...literals].sort());
  assert.ok(metrics.size >= 20);
  assert.ok(stored.has("clothlab_steps_total") && stored.has("clothlab_request_seconds_bucket"));
  assert.ok(!stored.has("clothlab_request_seconds"));
  for (const type of metrics.values()) assert.match(type, /^(?:counter|gauge|histogram)$/);
});

const words = new Set(["by", "without", "on", "ignoring", "and", "or", "unless", "bool", "offset", "inf", "nan"]);
/// The metrics and functions that an expression of PromQL names.
function names(expression) {
  const bare = expression
    .replace(/"(?:[^"\\]|\\.)*"/g, '""')
    .replace(/\{[^}]*\}|\[[^\]]*\]/g, " ")
    .replace(/\b(?:by|without|on|ignoring)\s*\([^)]*\)/g, " ");
  return [...bare.matchAll(/(?<![\w.:])([a-zA-Z_:][\w:]*)(?!\s*\()(?![\w:])/g)]
    .map(([, name]) => name)
    .filter((name) => !words.has(name.toLowerCase()));
}
const unknown = (expression) => names(expression).filter((name) => !stored.has(name) && !of_prometheus.includes(name));

test("the names in an expression are found", () => {
  assert.deepEqual(
    names('histogram_quantile(0.95, sum by (server, le) (rate(a_bucket{job="x", method!~"b|c[.]d"}[5m]))) > 1e3'),
    ["a_bucket"],
  );
  assert.deepEqual(names("a > 0 and increase(b[5m]) + sum(c) by (d) == 0 or vector(0)"), ["a", "b", "c"]);
  assert.deepEqual(unknown("clothlab_steps_total / clothlab_stepz_total"), ["clothlab_stepz_total"]);
  assert.deepEqual(unknown("clothlab_request_seconds"), ["clothlab_request_seconds"]);
});

const alerts = () => parse(read("docker/prometheus/alerts.yml")).groups.flatMap((group) => group.rules);
const scrape = () => parse(read("docker/prometheus/prometheus.yml")).scrape_configs;

test("alerts name only metrics that the server exports, and only of its job", { skip }, () => {
  const [{ job_name }, ...others] = scrape();
  assert.deepEqual(others, []);
  for (const { alert, expr } of alerts()) {
    assert.deepEqual(unknown(expr), [], alert);
    for (const [, job] of expr.matchAll(/\b(?:clothlab_\w+|up)\b(\{[^}]*\})?/g))
      assert.match(job ?? "", new RegExp(`^\\{job="${job_name}"`), alert);
  }
});

test("each alert has a severity, a summary that names the server, and says what to do", { skip }, () => {
  for (const { alert, labels, annotations } of alerts()) {
    assert.match(alert, /^Clothlab[A-Z]/);
    assert.match(labels.severity, /^(?:critical|warning|info)$/, alert);
    assert.match(annotations.summary, /\{\{ \$labels\.server \}\}/, alert);
    assert.ok(annotations.description.length > 100, alert);
  }
});

test("each alert is tested where it fires and where it does not, and described in the README", { skip }, () => {
  const { tests } = parse(read("docker/prometheus/alerts_test.yml"));
  const readme = read("docker/prometheus/README.md");
  const cases = tests.flatMap((one) => one.alert_rule_test);
  const of = (fires) =>
    [...new Set(cases.filter((one) => one.exp_alerts.length > 0 === fires).map((one) => one.alertname))].sort();
  const all = alerts()
    .map(({ alert }) => alert)
    .sort();
  assert.deepEqual(of(true), all);
  assert.deepEqual(of(false), all);
  assert.deepEqual([...new Set(readme.match(/\bClothlab[A-Z]\w+/g))].sort(), all);
  // Where it fires, another server, just short of the limit, does not.
  for (const { input_series, alert_rule_test } of tests) {
    const servers = new Set(input_series.map(({ series }) => /server="([^"]*)"/.exec(series)[1]));
    for (const { alertname, exp_alerts } of alert_rule_test)
      assert.ok(exp_alerts.length < servers.size, `${alertname} fires for all`);
  }
});

test("each server has a name of its own, and no token is in the configuration", { skip }, () => {
  for (const { static_configs, authorization } of scrape()) {
    const servers = static_configs.map(({ targets, labels }) => (assert.equal(targets.length, 1), labels.server));
    assert.ok(servers.length >= 2);
    assert.equal(new Set(servers).size, servers.length);
    assert.deepEqual(Object.keys(authorization), ["credentials_file"]);
  }
});

const board = () => JSON.parse(read("docker/grafana/clothlab.json"));
/// All panels, those of rows that are folded among them.
const panels = (dashboard) => dashboard.panels.flatMap((panel) => [panel, ...(panel.panels ?? [])]);

/// What is wrong with a dashboard, in sentences.
function faults(dashboard) {
  const found = [];
  const all = panels(dashboard);
  const seen = new Set();
  for (const { id, title, type, gridPos, fieldConfig, targets, datasource, description } of all) {
    if (!Number.isInteger(id) || seen.has(id)) found.push(`the id ${id} of "${title}" is another's, too`);
    seen.add(id);
    const { x, y, w, h } = gridPos;
    if (!(x >= 0 && y >= 0 && w > 0 && h > 0 && x + w <= 24)) found.push(`"${title}" is outside the grid`);
    for (const other of all) {
      const { x: left, y: top, w: width, h: height } = other.gridPos;
      if (other.id > id && x < left + width && left < x + w && y < top + height && top < y + h)
        found.push(`"${title}" and "${other.title}" overlap`);
    }
    if (type === "row") continue;
    if (!fieldConfig.defaults.unit) found.push(`"${title}" has no unit`);
    if (!description) found.push(`"${title}" has no description`);
    for (const source of [datasource, ...targets.map((target) => target.datasource)])
      if (!/^\$\{datasource\}$/.test(source.uid)) found.push(`"${title}" has the data source ${source.uid}`);
    for (const { expr, legendFormat } of targets) {
      found.push(...unknown(expr).map((name) => `"${title}": the server does not export ${name}`));
      if (!expr.includes('job="clothlab"')) found.push(`"${title}" does not ask for the job`);
      if (!expr.includes('server=~"$server"')) found.push(`"${title}" does not ask for the servers chosen`);
      for (const [, label] of legendFormat.matchAll(/\{\{(\w+)\}\}/g))
        if (!new RegExp(`by \\([^)]*\\b${label}\\b`).test(expr)) found.push(`"${title}" has no label ${label}`);
    }
  }
  return found;
}

test("the dashboard has unique ids, no panels that overlap, units, and only metrics that the server exports", () => {
  assert.deepEqual(faults(board()), []);
  const expressions = panels(board()).flatMap(({ targets = [] }) => targets.map(({ expr }) => expr));
  assert.ok(expressions.length >= 30);
});

test("the dashboard is bound to no Grafana of its maker's", () => {
  const dashboard = board();
  for (const key of ["id", "__inputs", "__requires", "gnetId"]) assert.ok(!(key in dashboard), key);
  assert.deepEqual(
    dashboard.templating.list.map(({ name }) => name),
    ["datasource", "server"],
  );
});

for (const [what, spoil, fault] of [
  ["an id twice", (all) => (all[3].id = all[2].id), /is another's/],
  ["panels that overlap", (all) => (all[3].gridPos.x -= 1), /overlap/],
  ["a panel beyond the edge", (all) => (all.at(-1).gridPos.w += 1), /outside/],
  ["a panel without a unit", (all) => delete all[2].fieldConfig.defaults.unit, /no unit/],
  ["a metric that is none", (all) => (all[3].targets[0].expr += " + clothlab_viewer"), /not export clothlab_viewer/],
  ["a histogram as a number", (all) => (all[3].targets[0].expr += " + clothlab_request_seconds"), /not export/],
  ["a data source by its id", (all) => (all[3].targets[0].datasource.uid = "P1809F7CD0C75ACF3"), /data source P18/],
  ["all servers where some are chosen", (all) => (all[3].targets[0].expr = 'up{job="clothlab"}'), /servers chosen/],
])
  test(`of a dashboard ${what} would be found`, () => {
    const dashboard = board();
    spoil(dashboard.panels);
    assert.match(faults(dashboard).join("\n"), fault);
  });

/// Rules of Prometheus that record the dashboard's expressions, its variables replaced as Grafana does.
const recorded = (expressions) =>
  JSON.stringify({
    groups: [
      {
        name: "dashboard",
        rules: expressions.map((expr, index) => ({
          record: `panel:${index}`,
          expr: expr.replaceAll("$__rate_interval", "1m").replaceAll("$server", "cloth-1|cloth-2"),
        })),
      },
    ],
  });

test("the dashboard's expressions are PromQL", { skip: no_promtool }, () => {
  const expressions = panels(board()).flatMap(({ targets = [] }) => targets.map(({ expr }) => expr));
  const check = (list) =>
    promtool(["check", "rules", "dashboard.yml"], (folder) =>
      writeFileSync(join(folder, "dashboard.yml"), recorded(list)),
    );
  const { status, said } = check(expressions);
  assert.equal(status, 0, said);
  for (const wrong of ["rate(clothlab_sessions)", "sum by server (up)", "up{server=~}"])
    assert.notEqual(check([...expressions, wrong]).status, 0, wrong);
});
