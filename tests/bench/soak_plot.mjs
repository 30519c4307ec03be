// The plot of a soak (tests/bench/soak.mjs): what the server held over the hours.

const width = 900,
  left = 70,
  right = 24,
  panelHeight = 120,
  gap = 34,
  top = 64;

/// A step of 1, 2 or 5 times a power of ten that divides `range` into about `ticks` parts.
function tickStep(range, ticks) {
  const raw = range / ticks,
    power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= raw);
}

/// An SVG document. `samples`, `rests`: [{minute, resident_MB, descriptors, threads}], all samples and those at rest.
export function soakPlot(samples, rests, result) {
  const panels = [
    { key: "resident_MB", name: "resident memory, MB" },
    { key: "descriptors", name: "file descriptors" },
    { key: "threads", name: "threads" },
  ];
  const longest = Math.max(...samples.map((s) => s.minute));
  const x = (minute) => left + ((width - left - right) * minute) / longest;
  const height = top + panels.length * (panelHeight + gap) + 20;
  const parts = [];
  panels.forEach(({ key, name }, i) => {
    const from = top + i * (panelHeight + gap),
      to = from + panelHeight;
    const most = 1.1 * Math.max(...samples.map((s) => s[key]), ...rests.map((s) => s[key]));
    const y = (value) => to - (panelHeight * value) / most;
    parts.push(`<text x="${left}" y="${from - 8}" class="name">${name}</text>`);
    const step = tickStep(most, 4);
    for (let value = 0; value <= most; value += step)
      parts.push(
        `<path d="M${left} ${y(value).toFixed(1)}H${width - right}" class="grid"/>`,
        `<text x="${left - 8}" y="${(y(value) + 4).toFixed(1)}" text-anchor="end">${Number(value.toPrecision(6))}</text>`,
      );
    parts.push(
      `<path d="M${samples.map((s) => `${x(s.minute).toFixed(1)} ${y(s[key]).toFixed(1)}`).join("L")}" class="busy"/>`,
    );
    parts.push(
      ...rests.map((s) => `<circle cx="${x(s.minute).toFixed(1)}" cy="${y(s[key]).toFixed(1)}" r="3.5" class="rest"/>`),
    );
  });
  const bottom = height - 30;
  const step = tickStep(longest, 8);
  for (let minute = 0; minute <= longest; minute += step)
    parts.push(
      `<text x="${x(minute).toFixed(1)}" y="${bottom}" text-anchor="middle">${Number(minute.toPrecision(6))}</text>`,
    );
  parts.push(`<text x="${width - right}" y="${bottom + 18}" text-anchor="end">minutes</text>`);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="system-ui, sans-serif" font-size="12">
<style>
text{fill:#334155}.title{font-size:16px;font-weight:600}.name{font-weight:600}
.grid{stroke:#e2e8f0}.busy{fill:none;stroke:#94a3b8}.rest{fill:#b03a2e}
</style>
<rect width="${width}" height="${height}" fill="#fff"/>
<text x="${left}" y="26" class="title">What the server holds through ${Math.round(result.minutes)} minutes of coming and going</text>
<g>
<path d="M${width - right - 250} 46h18" class="busy"/><text x="${width - right - 226}" y="50">busy</text>
<circle cx="${width - right - 170}" cy="46" r="3.5" class="rest"/>
<text x="${width - right - 160}" y="50">everybody has left</text>
</g>
${parts.join("\n")}
</svg>
`;
}
