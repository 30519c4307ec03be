// What tests/device/run measured, as Markdown.
const cell = (value) => (value === null || value === undefined ? "" : String(value));

/** A table of rows; no table without one. */
function table(columns, rows) {
  if (!rows || rows.length === 0) return [];
  const line = (cells) => `| ${cells.join(" | ")} |`;
  return [
    line(columns.map(([title]) => title)),
    line(columns.map(() => "---")),
    ...rows.map((row) => line(columns.map(([, key]) => cell(typeof key === "function" ? key(row) : row[key])))),
  ];
}

const named = ({ method, iterations }) => `\`${method}\`${iterations > 1 ? `, ${iterations} sweeps` : ""}`;
const size = ({ side }) => `${side}x${side}`;
const method = [
  ["method", named],
  ["size", size],
  ["ns a vertex and step", ({ ns, failed }) => ns ?? failed],
];

const quoted = (lines) => ["```", ...lines, "```"];

const sections = {
  device: ({ info = [], nvidia_smi, bandwidth_gb_s }) => [
    ...quoted([...info, nvidia_smi ?? ""].filter((line) => line)),
    ...(bandwidth_gb_s ? ["", `Memory: ${bandwidth_gb_s} GB/s.`] : []),
  ],
  selftest_quick: ({ checks, lines }) => (lines ? quoted(lines) : limits(checks ?? [])),
  hashes: ({ runs }) =>
    table(
      [
        ["scene", "scene"],
        ["method", named],
        ["three runs", ({ same }) => (same ? "equal" : "DIFFER")],
        ["state", ({ hashes }) => [...new Set(hashes)].join(", ")],
      ],
      runs,
    ),
  methods: ({ rows }) =>
    table(
      [...method, ["dispatches", "dispatches"], ["GB/s asked of memory", "gb_s"], ["share of the card's", "share"]],
      rows,
    ),
  surface: ({ rows }) =>
    table(
      [
        ["method", named],
        ["vertices", "vertices"],
        ["layers", "layers"],
        ["ms a step", ({ ms_a_step, failed }) => ms_a_step ?? failed],
        ["pairs", "pairs"],
      ],
      rows,
    ),
  reads: ({ rows }) => table([...method, ["reads", "choice"]], rows),
  sweeps: ({ rows }) => table([...method, ["sweeps", "choice"]], rows),
  served: ({ rows }) =>
    table(
      [
        ["scene", "scene"],
        ["frames a second", ({ frames_a_second, failed }) => frames_a_second ?? failed],
        ["gap, 95 of 100 [ms]", "gap_p95_ms"],
        ["latency, 95 of 100 [ms]", "latency_p95_ms"],
        ["real-time factor", "real_time_factor"],
        ["a step is answered after [ms]", "step_answered_ms"],
      ],
      rows,
    ),
  selftest: ({ checks, lines }) => (lines ? quoted(lines) : outcome(checks ?? [])),
};

const outcome = (checks) => {
  if (checks.length === 0) return [];
  const wrong = checks.filter(({ passed }) => !passed);
  return [
    `${checks.length} checks, ${wrong.length} wrong.`,
    ...wrong.map(({ name, found, allowed, unit }) => `* ${name}: ${found} ${unit}, ${allowed} allowed`),
  ];
};

function limits(checks) {
  const rows = checks.filter(({ name }) => name.startsWith("limit: "));
  return [
    ...outcome(checks),
    "",
    ...table(
      [
        ["limit", ({ name }) => name.slice("limit: ".length)],
        ["needed", "found"],
        ["allowed", "allowed"],
      ],
      rows,
    ),
  ];
}

/** The whole file. */
export function markdown(result) {
  const lines = [
    `# ${result.device?.name ?? "An OpenGL device"}`,
    "",
    `${result.date.slice(0, 10)}, commit ${result.commit}, ${result.processor}, ${result.seconds} s${result.small ? ", small sizes" : ""}.`,
  ];
  for (const [name, section] of Object.entries(sections)) {
    const part = result[name];
    if (!part) continue;
    const title = name.replace("_quick", ", quick");
    lines.push("", `## ${title[0].toUpperCase()}${title.slice(1)}`, "");
    for (const key of ["failed", "left_out"]) if (part[key]) lines.push(`${key.replace("_", " ")}: ${part[key]}`, "");
    lines.push(...section(part));
  }
  return `${lines
    .join("\n")
    .replace(/\n{3,}/g, "\n\n")
    .trimEnd()}\n`;
}
