// The refusal of a scene whose surfaces already pass through each other: where, and what to do instead.
import { notice } from "./notices";
import type { Crossings, CrossingPart, RpcError } from "../link/rpc";
import type { Patch } from "../link/scene_types";

const mostNamed = 3;

interface Host {
  show(crossings: Crossings): void;
  hide(): void;
  send(patch: Patch): void;
}

/// The same patch, but for the kind of self-collision: points, which may have crossings.
export function underPoints(patch: Patch): Patch {
  if (Array.isArray(patch)) return [...patch, { op: "replace", path: "/self_collision/kind", value: "points" }];
  return { ...patch, self_collision: { ...(patch.self_collision as object | undefined), kind: "points" } };
}

const named = ({ vertices, name }: CrossingPart): string => `${vertices.join("-")} of ${name}`;

/// Tells the refusal of `patch`. Returns a function that takes the notice away; null, and nothing is told, if the
/// refusal has another reason.
export function tellCrossings(title: string, error: RpcError, patch: Patch, host: Host): (() => void) | null {
  const { crossings, path } = error.data;
  if (!crossings) return null;
  const ofCloth = path === "/self_collision/kind"; // else cloth meets a body
  const { when, count, complete, pairs } = crossings;
  const many = `${count}${complete ? "" : " or more"} ${count === 1 ? "place" : "places"}`;
  const subject = when === "start" ? "The scene would start with cloth" : "At present there is cloth";
  const list = pairs
    .slice(0, mostNamed)
    .map(({ edge, triangle }) => `edge ${named(edge)} × triangle ${named(triangle)}`);
  return notice("error", {
    title,
    lines: [
      ofCloth
        ? `${subject} passing through cloth, in ${many}. “Surface” keeps apart only what is apart.`
        : `${subject} passing through a body, in ${many}. Contact keeps apart only what is apart.`,
      ...list.map((pair, i) => (i === mostNamed - 1 && count > mostNamed ? `${pair}, …` : pair)),
    ],
    stays: true,
    closed: () => host.hide(),
    actions: [
      { label: "Show me", keeps: true, run: () => host.show(crossings) },
      ...(ofCloth ? [{ label: "Use points instead", run: () => host.send(underPoints(patch)) }] : []),
    ],
  });
}
