// docker/kubernetes/*.yaml: what Kubernetes' schemas allow and nothing else, and as docker/compose.yaml has it.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const installed = existsSync(join(root, "tests/node_modules/kubernetes-models"));
const skip = !installed && "tests/node_modules is not installed: tests/run does it";
const require = createRequire(import.meta.url);

const yaml = installed ? require("yaml") : undefined;
/// The documents of a file, read as Kubernetes does: by YAML 1.1, where `on` is true and 0440 octal.
const documents = (text) =>
  yaml.parseAllDocuments(text, { version: "1.1" }).map((document) => {
    assert.deepEqual([...document.errors, ...document.warnings], []);
    return document.toJS();
  });
const read = (file) => documents(readFileSync(join(root, file), "utf8"));
const manifests = files.filter((file) => /^docker\/kubernetes\/.*\.ya?ml$/.test(file));
const find = (name, kind, title) =>
  read(`docker/kubernetes/${name}`).find((one) => one.kind === kind && one.metadata.name === title);

/// A view of a value that notes which of its fields are asked for, and the paths of those that never were.
function observed(value) {
  const nodes = [];
  const view = (target, path) => {
    if (target === null || typeof target !== "object") return target;
    const asked = new Set();
    const inside = new Map();
    nodes.push(() => Object.keys(target).flatMap((key) => (asked.has(key) ? [] : [`${path}/${key}`])));
    return new Proxy(target, {
      get(_, key) {
        if (!Object.hasOwn(target, key) || key === "length") return target[key];
        asked.add(key);
        if (!inside.has(key)) inside.set(key, view(target[key], `${path}/${key}`));
        return inside.get(key);
      },
      // A map's names are asked for all at once: labels, a ConfigMap's data.
      ownKeys: () => Reflect.ownKeys(target).map((key) => (asked.add(key), key)),
    });
  };
  return { view: view(value, ""), never_asked: () => nodes.flatMap((node) => node()) };
}

/// What Kubernetes' schema has against a document. The package's validators pass over fields that a schema does not
/// have, as JSON Schema does; such a field is one that the validator, which asks for all that the schema has, never
/// asks for.
function objections(document) {
  const [group, version] = document.apiVersion.includes("/") ? document.apiVersion.split("/") : ["", "v1"];
  const { [document.kind]: Model } = require(["kubernetes-models", group, version].filter(Boolean).join("/"));
  if (!Model) return [`/kind: ${document.apiVersion} has no ${document.kind}`];
  const { view, never_asked } = observed(document);
  try {
    Model.prototype.validate.call(view);
  } catch (error) {
    return error.errors.map(({ instancePath, message }) => `${instancePath}: ${message}`);
  }
  return never_asked().map((path) => `${path}: no such field`);
}

test("every document is what Kubernetes' schemas allow", { skip }, () => {
  assert.deepEqual(manifests.sort(), [
    "docker/kubernetes/relay.yaml",
    "docker/kubernetes/serve.yaml",
    "docker/kubernetes/sweep.yaml",
  ]);
  const wrong = manifests.flatMap((file) =>
    read(file).flatMap((one) => objections(one).map((what) => `${file}, ${one.kind} ${one.metadata.name}${what}`)),
  );
  assert.deepEqual(wrong, []);
});

const job = () => find("sweep.yaml", "Job", "clothlab-sweep");
const server = () => find("serve.yaml", "StatefulSet", "clothlab");
for (const [what, document, spoil, objection] of [
  ["a misspelt field of a job", job, ({ spec }) => (spec.backoffLimitPerIndexx = 3), "/spec/backoffLimitPerIndexx: no"],
  [
    "a misspelt field deep inside",
    job,
    ({ spec }) => (spec.template.spec.containers[0].volumeMounts[1].readonly = true),
    "/spec/template/spec/containers/0/volumeMounts/1/readonly: no such field",
  ],
  [
    "a field in the wrong place",
    server,
    ({ spec }) => (spec.template.spec.containers[0].runAsUser = 10001),
    "/spec/template/spec/containers/0/runAsUser: no such field",
  ],
  ["a text for a number", job, ({ spec }) => (spec.completions = "8"), "/spec/completions: must be integer"],
  [
    "a number for a text",
    server,
    ({ spec }) => (spec.template.spec.containers[0].env[0].value = 2),
    "/spec/template/spec/containers/0/env/0/value: must be string",
  ],
  ["a word that is none of the choice", job, ({ spec }) => (spec.completionMode = "indexed"), "/spec/completionMode: "],
  [
    "an amount that is none",
    server,
    ({ spec }) => (spec.template.spec.containers[0].resources.limits.memory = "2g"),
    "/spec/template/spec/containers/0/resources/limits/memory: ",
  ],
  ["a job without a template", job, ({ spec }) => delete spec.template, "/spec: must have required property template"],
  [
    "a container without a name",
    server,
    ({ spec }) => delete spec.template.spec.containers[0].name,
    "/spec/template/spec/containers/0: must have required property name",
  ],
  [
    "a server's volume that is misspelt",
    server,
    ({ spec }) => (spec.volumeClaimTemplates[0].spec.accessMode = "ReadWriteOnce"),
    "/spec/volumeClaimTemplates/0/spec/accessMode: no such field",
  ],
  ["a kind that is none", job, (one) => (one.kind = "Jobs"), "/kind: "],
])
  test(`the schemas refuse ${what}`, { skip }, () => {
    const spoilt = document();
    spoil(spoilt);
    assert.match(objections(spoilt).join("\n"), new RegExp(`^${objection}`, "m"));
  });

/// The pods of the files, by name.
const pods = () =>
  manifests
    .flatMap(read)
    .flatMap(({ metadata, spec }) => (spec?.template ? [[metadata.name, spec.template.spec]] : []));
const compose = () => read("docker/compose.yaml")[0].services.clothlab;

test("pods have the image, the user and the locks that the container has", { skip }, () => {
  const [, user] = /^USER (\d+):\1$/m.exec(readFileSync(join(root, "docker/Dockerfile"), "utf8"));
  const { image, read_only, cap_drop, security_opt } = compose();
  assert.deepEqual(security_opt, ["no-new-privileges:true"]);
  assert.deepEqual(
    pods()
      .map(([name]) => name)
      .sort(),
    ["clothlab", "clothlab-relay", "clothlab-sweep", "clothlab-sweep-merge"],
  );
  for (const [name, pod] of pods()) {
    const [container, ...others] = pod.containers;
    assert.deepEqual(others, [], name);
    // What another registry calls clothlab is not ours: Compose builds it, and Kubernetes has it or does without.
    assert.deepEqual([container.image, container.imagePullPolicy], [image, "Never"], name);
    assert.deepEqual(
      container.securityContext,
      { allowPrivilegeEscalation: false, readOnlyRootFilesystem: read_only, capabilities: { drop: cap_drop } },
      name,
    );
    const { runAsNonRoot, runAsUser, runAsGroup, fsGroup, seccompProfile } = pod.securityContext;
    assert.deepEqual(
      { runAsNonRoot, runAsUser, runAsGroup, fsGroup, seccompProfile },
      {
        runAsNonRoot: true,
        runAsUser: Number(user),
        runAsGroup: Number(user),
        fsGroup: Number(user),
        seccompProfile: { type: "RuntimeDefault" },
      },
      name,
    );
    assert.deepEqual([pod.automountServiceAccountToken, pod.enableServiceLinks], [false, false], name);
    if (name === "clothlab-relay") continue; // it writes nothing
    const volumes = new Map(pod.volumes.map(({ name, ...volume }) => [name, volume]));
    const mounts = new Map(container.volumeMounts.map(({ name, mountPath }) => [mountPath, name]));
    assert.deepEqual(volumes.get(mounts.get("/tmp")), { emptyDir: { medium: "Memory", sizeLimit: "64Mi" } }, name);
  }
});

test("the server has the port, the folder of the state, the token and the limits that compose.yaml has", {
  skip,
}, () => {
  const service = compose();
  const { spec } = server();
  const [container] = spec.template.spec.containers;
  const mount = (name) => container.volumeMounts.find((one) => one.name === name).mountPath;
  assert.equal(mount(spec.volumeClaimTemplates[0].metadata.name), service.volumes[0].split(":")[1]);

  const port = Number(service.ports[0].split(":").at(-1));
  assert.deepEqual(container.ports, [{ name: "http", containerPort: port }]);
  const outside = find("serve.yaml", "Service", spec.serviceName).spec;
  assert.deepEqual(outside.ports, [{ name: "http", port, targetPort: "http" }]);
  assert.deepEqual(outside.selector, spec.template.metadata.labels);
  assert.deepEqual(spec.selector.matchLabels, spec.template.metadata.labels);

  const entrypoint = readFileSync(join(root, "docker/entrypoint"), "utf8");
  const given = (variable) => container.env.find(({ name }) => name === variable)?.value;
  for (const name of Object.keys(service.environment)) assert.match(entrypoint, new RegExp(`^from_file ${name}$`, "m"));
  assert.equal(given("CLOTHLAB_TOKEN_FILE"), `${mount("token")}/token`);
  const secret = spec.template.spec.volumes.find(({ name }) => name === "token").secret;
  assert.deepEqual([secret.defaultMode, secret.items], [0o440, [{ key: "token", path: "token" }]]);
  const { data, stringData } = find("serve.yaml", "Secret", secret.secretName);
  assert.deepEqual([data, stringData], [undefined, undefined], "a token that everybody can read");

  const limits = JSON.stringify(service.deploy.resources.limits);
  assert.deepEqual(container.resources, {
    limits: { cpu: /cpus":"[^"]*:-(\d+)/.exec(limits)[1], memory: `${/memory":"[^"]*:-(\d+)g/.exec(limits)[1]}Gi` },
  });
  assert.equal(given("LP_NUM_THREADS"), container.resources.limits.cpu);
  assert.equal(`${spec.template.spec.terminationGracePeriodSeconds}s`, service.stop_grace_period);
  for (const probe of ["startupProbe", "livenessProbe", "readinessProbe"])
    assert.deepEqual(container[probe].httpGet, { path: "/healthz", port: "http" });
});

test("relays have the server's port and probes, and the address of the bus from a secret that the file leaves empty", {
  skip,
}, () => {
  const { spec } = find("relay.yaml", "Deployment", "clothlab-relay");
  const [container] = spec.template.spec.containers;
  const [serving] = server().spec.template.spec.containers;
  for (const field of ["ports", "startupProbe", "livenessProbe", "readinessProbe"])
    assert.deepEqual(container[field], serving[field], field);
  const outside = find("relay.yaml", "Service", "clothlab-relay").spec;
  assert.deepEqual(outside.ports, find("serve.yaml", "Service", "clothlab").spec.ports);
  for (const labels of [outside.selector, spec.selector.matchLabels])
    assert.deepEqual(labels, spec.template.metadata.labels);
  const [{ name, valueFrom }] = container.env;
  assert.equal(name, "CLOTHLAB_FROM");
  const { data, stringData } = find("relay.yaml", "Secret", valueFrom.secretKeyRef.name);
  assert.deepEqual([data, stringData], [undefined, undefined]);
});

test("the pods of a sweep measure each shard once, and the n of --shard i/n is the number of completions", {
  skip,
}, () => {
  const { completionMode, completions, template } = job().spec;
  assert.equal(completionMode, "Indexed");
  const [{ command, volumeMounts, resources, args }] = template.spec.containers;
  assert.equal(args, undefined);
  // The pod's command as it is, with a clothlab that tells its arguments.
  const [shell, option, line] = command;
  assert.match(line, /^exec clothlab /);
  const shards = Array.from({ length: completions }, (_, index) => {
    const { stdout, stderr } = spawnSync(shell, [option, line.replace("exec clothlab", "printf '%s\\n'")], {
      encoding: "utf8",
      env: { PATH: process.env.PATH, JOB_COMPLETION_INDEX: String(index) },
      stdio: ["ignore", "pipe", "pipe"], // from a socket bash would take its input for rsh's, and read .bashrc
    });
    assert.equal(stderr, "");
    return stdout.trim().split("\n");
  });
  const mount = (name) => volumeMounts.find((one) => one.name === name).mountPath;
  const config = find("sweep.yaml", "ConfigMap", "clothlab-sweep").data;
  const [file] = Object.keys(config);
  assert.deepEqual(
    shards,
    shards.map((_, index) => {
      const shard = `${index + 1}/${completions}`;
      return ["sweep", `${mount("sweep")}/${file}`, "--out", mount("results"), "--shard", shard];
    }),
  );
  const points = JSON.parse(config[file]).axes.reduce(
    (product, axis) => product * (axis.count ?? axis.values.length),
    1,
  );
  assert.ok(points >= completions, "a shard without a point");
  // Cores of its own, with the static policy of kubelet's CPU manager.
  assert.deepEqual(resources.requests, resources.limits);
  assert.match(resources.limits.cpu, /^\d+$/);
});

test("both jobs of a sweep have one folder of results, which several pods may write", { skip }, () => {
  const claim = find("sweep.yaml", "PersistentVolumeClaim", "clothlab-sweep");
  assert.deepEqual(claim.spec.accessModes, ["ReadWriteMany"]);
  const merge = find("sweep.yaml", "Job", "clothlab-sweep-merge").spec;
  assert.equal(merge.suspend, true);
  assert.deepEqual(merge.template.spec.containers[0].args, ["sweep", "--merge", "/results"]);
  for (const { template } of [job().spec, merge]) {
    assert.equal(template.spec.restartPolicy, "Never");
    assert.ok(template.spec.containers[0].volumeMounts.some(({ mountPath }) => mountPath === "/results"));
    const { persistentVolumeClaim } = template.spec.volumes.find(({ name }) => name === "results");
    assert.equal(persistentVolumeClaim.claimName, claim.metadata.name);
  }
});

test("a pod that is evicted or stopped is no failure of its shard, and any other is one", { skip }, () => {
  const [, signal] = /exit_interrupted =\s+128 \+ (SIG\w+)/.exec(
    readFileSync(join(root, "server/cli/long_job.h"), "utf8"),
  );
  assert.equal(signal, "SIGINT");
  assert.deepEqual(job().spec.podFailurePolicy.rules, [
    { action: "Ignore", onPodConditions: [{ type: "DisruptionTarget", status: "True" }] },
    { action: "Ignore", onExitCodes: { containerName: "clothlab", operator: "In", values: [128 + 2] } },
  ]);
});
