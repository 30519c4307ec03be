// The refusal of a scene whose surfaces already pass through each other: where, and what to do instead.
import { notice } from "./notices";
import type { Crossings, CrossingPart, RpcError } from "../link/rpc";
import type { Patch, SceneDocument } from "../link/scene_types";

const mostNamed = 3;
export const ofCloth = "/self_collision/kind"; // the place of a refusal for cloth that meets cloth; else it meets a body

interface Host {
  show(crossings: Crossings): void;
  hide(): void;
  send(patch: Patch): void;
  stored(): SceneDocument | null;
}

/// A start that leads cloth out of what it goes through, in a second at most.
export const start = { dress: 1 };

/// The same patch, but for the kind of self-collision: points, which may have crossings.
export function underPoints(patch: Patch): Patch {
  if (Array.isArray(patch)) return [...patch, { op: "replace", path: "/self_collision/kind", value: "points" }];
  return { ...patch, self_collision: { ...(patch.self_collision as object | undefined), kind: "points" } };
}

/// The same patch, and the cloths that cross are led out.
function ledOut(patch: Patch, { pairs }: Crossings, stored: SceneDocument | null): Patch {
  const cloths = new Set(pairs.flatMap(({ edge, triangle }) => [edge.cloth, triangle.cloth]));
  if (Array.isArray(patch))
    return [
      ...patch,
      ...[...cloths].flatMap((cloth) =>
        cloth === undefined ? [] : [{ op: "add" as const, path: `/cloths/${cloth}/start`, value: start }],
      ),
    ];
  const all = (Array.isArray(patch.cloths) ? patch.cloths : (stored?.cloths ?? [])) as object[];
  return { ...patch, cloths: all.map((cloth, i) => (cloths.has(i) ? { ...cloth, start } : cloth)) };
}

/// True if this patch, or the scene as it is, leads out all that cross: to ask for it again would change nothing.
function triedIn(patch: Patch, { pairs }: Crossings, stored: SceneDocument | null): boolean {
  if (JSON.stringify(patch).includes(JSON.stringify(start))) return true;
  const cloths = pairs.flatMap(({ edge, triangle }) => [edge.cloth, triangle.cloth]);
  return cloths.every((cloth) => cloth === undefined || "dress" in (stored?.cloths[cloth]?.start ?? {}));
}

const named = ({ vertices, name }: CrossingPart): string => `${vertices.join("-")} of ${name}`;

/// What passes through what, and the first `most` edges and triangles; none if the refusal has another reason.
export function crossingLines({ data: { crossings, path } }: RpcError, most = mostNamed): string[] {
  if (!crossings) return [];
  const { when, count, complete, pairs } = crossings;
  const many = `${count}${complete ? "" : " or more"} ${count === 1 ? "place" : "places"}`;
  const subject = when === "start" ? "The scene would start with cloth" : "At present there is cloth";
  const list = pairs.slice(0, most).map(({ edge, triangle }) => `edge ${named(edge)} × triangle ${named(triangle)}`);
  return [
    path === ofCloth
      ? `${subject} passing through cloth, in ${many}. “Surface” keeps apart only what is apart.`
      : `${subject} passing through a body, in ${many}. Contact keeps apart only what is apart.`,
    ...list.map((pair, i) => (i === most - 1 && count > most ? `${pair}, …` : pair)),
  ];
}

/// Tells the refusal of `patch`. Returns a function that takes the notice away; null, and nothing is told, if the
/// refusal has another reason.
export function tellCrossings(title: string, error: RpcError, patch: Patch, host: Host): (() => void) | null {
  const { crossings, path } = error.data;
  if (!crossings) return null;
  return notice("error", {
    title,
    lines: crossingLines(error),
    stays: true,
    closed: () => host.hide(),
    actions: [
      { label: "Show me", keeps: true, run: () => host.show(crossings) },
      ...(crossings.when === "start" && !triedIn(patch, crossings, host.stored())
        ? [{ label: "Lead it out", run: () => host.send(ledOut(patch, crossings, host.stored())) }]
        : []),
      ...(path === ofCloth ? [{ label: "Use points instead", run: () => host.send(underPoints(patch)) }] : []),
    ],
  });
}
