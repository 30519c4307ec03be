// Files of the user's own, opened: sent to the session, asked about, put into the scene.
import { ask } from "./dialog";
import type { OpenHost } from "./door";
import { holds, sizeText, type Unit, units, type Up } from "./guess";
import { type Answers, type Aside, beside, contact, extent, falls, patchFor, thicknessIn } from "./scene";
import { content, freeFileName, largestMessage, type Uploaded, withBuffers } from "../link/mesh_upload";
import { RpcError } from "../link/rpc";
import type { Operation, SceneDocument, Vec3 } from "../link/scene_types";
import { shiftedPlace } from "../link/shifted_cloth";
import { crossingLines, ofCloth, start } from "../panel/crossings";
import { methodText } from "../panel/methods";
import { type Action, notice, noticeError } from "../panel/notices";
import { secondsText } from "../panel/solver_section";

export { showDropPicture } from "./drop_picture";

const toRead = 14_000; // [ms]

/// The server's answer to the patch.
interface Done {
  solver?: SceneDocument["solver"];
}

const isMesh = ({ name }: File): boolean => /\.(obj|ply|glb|gltf)$/i.test(name);
const read = async (file: File): Promise<Uint8Array> => new Uint8Array(await file.arrayBuffer());
const refuse = (title: string, line: string): void => void notice("error", { title, lines: [line] });

/// Mean edges of what was opened, by the names of uploads, in the files' unit.
const edges = new Map<string, number>();

const fileOf = ({ mesh }: { mesh?: object }): string | undefined =>
  mesh && ("file" in mesh ? String(mesh.file) : "obj" in mesh ? String(mesh.obj) : undefined);

/// What the scene has of files.
function named({ cloths, colliders }: SceneDocument): { file: string; scale: number; rotate: number[] }[] {
  return [...cloths, ...colliders].flatMap((each) => {
    const file = fileOf(each as { mesh?: object });
    return file && "transform" in each ? [{ file, scale: each.transform.scale, rotate: each.transform.rotate }] : [];
  });
}

async function send(
  file: File,
  name: string,
  beside: Map<string, Uint8Array>,
  host: OpenHost,
): Promise<Uploaded | null> {
  const made = content(await read(file));
  if (/\.gltf$/i.test(file.name)) made.obj = withBuffers(made.obj, beside);
  const parameters = { name, ...made };
  if (JSON.stringify(parameters).length + 200 > largestMessage) {
    refuse(
      `${file.name} is too large`,
      "An upload may have 8 MiB. Larger files: start the server with --asset-root, and name the file in the scene.",
    );
    return null;
  }
  try {
    return await host.request<Uploaded>("mesh.upload", parameters);
  } catch (error) {
    if (error instanceof RpcError) noticeError(`${file.name} was refused`, error);
    return null;
  }
}

/// Takes files that the user has chosen or dropped.
export async function openFiles(files: File[], host: OpenHost): Promise<void> {
  if (!host.mayEdit()) return refuse("Only operators may open files", "You are a viewer of this session.");
  const stored = host.stored();
  if (!stored) return;
  const meshes = files.filter(isMesh);
  const other = files.find((file) => !isMesh(file) && !/\.(bin|mtl)$/i.test(file.name));
  if (other || meshes.length === 0)
    return refuse(
      `${(other ?? files[0])?.name} is no mesh`,
      "The page takes .obj, .ply, .glb and .gltf files, and scenes as .json; other formats can be converted.",
    );
  const buffers = files.filter(({ name }) => /\.bin$/i.test(name));
  const besides = new Map(await Promise.all(buffers.map(async (file) => [file.name, await read(file)] as const)));
  const taken = new Set(named(stored).map(({ file }) => file));
  const sent: Uploaded[] = [];
  for (const file of meshes) {
    const name = freeFileName(file.name, taken);
    taken.add(name);
    const answer = await send(file, name, besides, host);
    if (answer) sent.push(answer);
  }
  if (sent.length === 0) return;
  for (const { name, mean_edge } of sent) edges.set(name, mean_edge);
  const answers = await ask({ files: sent, ...present(stored), fabrics: host.fabrics() });
  const now = host.stored();
  if (answers && now) await put(answers, now, host);
}

/// What the dialogue asks with, of the scene that is there.
function present(stored: SceneDocument): {
  scene: string;
  adds: boolean;
  carries: boolean;
  edge: number | null;
  before: { unit: Unit; up: Up } | null;
} {
  const own = named(stored);
  const adds = own.some(({ file }) => edges.has(file));
  const unit = units.find(({ factor }) => factor === own[0]?.scale);
  const up = own[0]?.rotate[0] === -90 ? "z" : own[0]?.rotate[2] === 90 ? "x" : "y";
  const known = own.flatMap(({ file, scale }) => (edges.has(file) ? [(edges.get(file) as number) * scale] : []));
  return {
    scene: stored.name,
    adds,
    carries: stored.colliders.length > 0,
    edge: known.length > 0 ? Math.min(...known) : null,
    before: adds && unit ? { unit, up } : null,
  };
}

/// Puts it in where the files have it; where cloth would go through something, elsewhere, so that nothing is lost.
async function put(answers: Answers, stored: SceneDocument, host: OpenHost): Promise<void> {
  const paused = falls(answers, stored, answers.fresh);
  const title = `Open ${answers.items[0]?.file ?? "files"}`;
  const aside: Aside = { move: [0, 0, 0], points: false };
  const refusals: RpcError[] = [];
  host.pause();
  for (;;) {
    const patch = patchFor(answers, stored, aside, host.presets());
    try {
      const done = await host.request<Done>("scene.patch", { patch, name: title.slice(0, 60), keep_stable: true });
      host.fit();
      if (!paused && refusals.length === 0) host.play();
      if (refusals.length > 0) tellAside(answers, stored, aside, refusals, host);
      else tell(answers, stored, done, paused, host);
      return;
    } catch (error) {
      if (!(error instanceof RpcError)) return;
      const { crossings, path } = error.data;
      const cloth = path === ofCloth;
      const again = crossings !== undefined && (cloth ? !aside.points : aside.move[0] === 0);
      const move = beside(answers);
      if (!again || (!cloth && move[0] === 0)) return host.refused(`${title} was refused`, error, patch);
      refusals.push(error);
      if (cloth) aside.points = true;
      else aside.move = move;
    }
  }
}

const sentence = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
const listed = (names: string[]): string => names.join(" and ");

/// Says what was chosen, and offers to hold what would fall.
function tell(answers: Answers, stored: SceneDocument, { solver }: Done, paused: boolean, host: OpenHost): void {
  const { items, factor } = answers;
  const shown = items.filter(({ role }) => role !== "none");
  const fits = contact(answers);
  const kept = thicknessIn(answers, stored);
  const box = extent(answers);
  const unit = units.find((each) => each.factor === factor)?.name ?? "";
  const fabrics = [...new Set(items.filter(({ role }) => role === "cloth").map(({ fabric }) => fabric))];
  const lines = [
    box ? `In ${unit}: ${sizeText(box)}.` : "",
    kept !== null && fits ? `Surfaces keep ${text(kept)} mm apart; edges measure ${text(fits.edge)} mm.` : "",
    solver && fabrics.length > 0
      ? `${sentence(listed(fabrics))}, stepped by ${methodText(solver.method).name}, ${secondsText(solver.dt)}.`
      : "",
    paused ? "Nothing holds it: paused, or it would fall." : "",
  ];
  const close = notice("info", {
    title: `Opened ${listed(shown.map(({ file, part }) => part.node ?? file))}`,
    lines: lines.filter((line) => line !== ""),
    actions: paused ? holdActions(answers, stored, host) : [],
    stays: true, // a phone has room for one notice: that the cloth was rebuilt must not take it away
  });
  if (!paused) setTimeout(close, toRead);
}

const text = (metres: number): string => String(Number((1000 * metres).toPrecision(3)));

/// A button for each place where the first cloth that nothing holds can hang.
function holdActions(answers: Answers, stored: SceneDocument, host: OpenHost): Action[] {
  const cloths = answers.items.filter(({ role }) => role === "cloth");
  const loose = cloths.findIndex(({ held }) => held.length === 0);
  const item = cloths[loose];
  if (!item) return [];
  const index = (answers.fresh ? 0 : stored.cloths.length) + loose;
  return holds(item.part, answers.up).map(({ name, vertices }) => ({
    label: `Hold the ${name}`,
    run: () => {
      const value = vertices.map((vertex) => ({ at: `vertex:${vertex}` }));
      const patch: Operation[] = [{ op: "replace", path: `/cloths/${index}/pins`, value }];
      host.request("scene.patch", { patch, name: `Hold the ${name}` }).then(
        () => host.play(),
        (error: Error) => host.refused("Not held", error, patch),
      );
    },
  }));
}

/// Says what goes through what, and that nothing is lost; offers to try the files' places again.
function tellAside(answers: Answers, stored: SceneDocument, aside: Aside, refusals: RpcError[], host: OpenHost): void {
  const moved = aside.move[0] !== 0;
  const first = answers.fresh ? 0 : stored.cloths.length;
  const cloths = answers.items.filter(({ role }) => role === "cloth").length;
  // As far back as it was put aside: the user may have moved and scaled it meanwhile.
  const back = (): Operation[] => [
    ...(host.stored()?.cloths ?? []).slice(first, first + (moved ? cloths : 0)).map(
      ({ transform: { translate } }, i): Operation => ({
        op: "replace",
        path: `/cloths/${first + i}/transform/translate`,
        value: shiftedPlace(translate, aside.move.map((value) => -value) as Vec3),
      }),
    ),
    ...(aside.points ? [{ op: "replace", path: "/self_collision/kind", value: "surface" } as Operation] : []),
  ];
  const last = refusals[refusals.length - 1] as RpcError;
  const crossings = last.data.crossings;
  const leadOut = (): Operation[] =>
    Array.from({ length: cloths }, (_, i) => ({ op: "add", path: `/cloths/${first + i}/start`, value: start }));
  const again = (name: string, more: Operation[]): void => {
    const patch = [...back(), ...more];
    host.request("scene.patch", { patch, name }).then(
      () => host.play(),
      (error: Error) => {
        if (error instanceof RpcError && error.data.crossings) tellAside(answers, stored, aside, [error], host);
        else host.refused("Not put in place", error, patch);
      },
    );
  };
  notice("error", {
    title: "Where its file has it, cloth would go through something",
    lines: [
      ...refusals.flatMap((error) => crossingLines(error, 1)),
      moved
        ? "So it stands beside the body, paused. Move, turn or scale it; put back, it is tried again."
        : "So points keep apart instead of surfaces, paused.",
    ],
    stays: true,
    closed: () => host.hideCrossings(),
    actions: [
      ...(crossings ? [{ label: "Show me", keeps: true, run: () => host.showCrossings(crossings) }] : []),
      ...(crossings ? [{ label: "Lead it out", run: () => again("Lead out", leadOut()) }] : []),
      { label: moved ? "Put it back" : "Try surfaces", run: () => again("Put in place", []) },
    ],
  });
}
