// What axe-core, a checker of accessibility, says of a page.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { thorough } from "../thorough.mjs";
import { arrived } from "./browser.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const rules = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];

/// What axe-core finds wrong, each with the elements and the reason. Of the whole page it takes a second: unless the
/// run is thorough, it looks at the elements that the selector `card` names alone.
export async function violations({ page }, when, card = "html") {
  await arrived(page);
  if (!(await page.evaluate(() => "axe" in window))) await page.evaluate(axe);
  const found = await page.evaluate(
    async ([within, values]) => (await window.axe.run(within, { runOnly: { type: "tag", values } })).violations,
    [thorough ? "html" : card, rules],
  );
  return found.flatMap(({ id, nodes }) =>
    nodes.map(({ target, any, all, none }) => `${when}: ${id}: ${target}: ${[...any, ...all, ...none][0]?.message}`),
  );
}
