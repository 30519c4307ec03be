// A scene's file dropped on the page, perhaps with the meshes that it names: loaded, or shown with what is wrong in it.
import type { TextDrawer } from "./drawer";
import type { TextHost } from "./host";
import { isFault, readJson } from "./json_text";
import { load } from "./load";
import { content } from "../link/mesh_upload";
import { RpcError } from "../link/rpc";
import type { SceneDocument } from "../link/scene_types";
import { notice, noticeError } from "../panel/notices";

const isScene = (file: File): boolean => /\.json$/i.test(file.name);

export async function takeScene(files: File[], host: TextHost, drawer: TextDrawer): Promise<void> {
  const [file, second] = files.filter(isScene);
  if (!file) return;
  if (second)
    return void notice("error", {
      title: "Two scenes at once",
      lines: [`${file.name} and ${second.name} were dropped; drop one of them.`],
    });
  const text = await file.text();
  const read = readJson(text);
  if (isFault(read)) {
    const where = `Line ${read.line}, column ${read.column}: ${read.says}.`;
    notice("error", { title: `${file.name} is no JSON`, lines: [where] });
    return drawer.show(text, where, read.line);
  }
  if (!host.mayEdit())
    return void notice("error", { title: "Only operators may load a scene", lines: ["You are a viewer here."] });
  for (const mesh of files.filter((each) => !isScene(each))) {
    const uploaded = await host
      .request("mesh.upload", { name: mesh.name, ...content(new Uint8Array(await mesh.arrayBuffer())) })
      .catch((error: Error) => error);
    if (uploaded instanceof Error) return noticeError(`${mesh.name} was refused`, uploaded);
  }
  try {
    await load(read.value as SceneDocument, host);
  } catch (error) {
    const { path, found, allowed } = error instanceof RpcError ? error.data : {};
    const line = path?.startsWith("/") && !path.startsWith("/scene/") ? read.lineOf(path) : 0;
    noticeError(`${file.name} was refused${line ? `: line ${line}` : ""}`, error as Error);
    drawer.show(
      text,
      line ? `Line ${line}: ${path} is ${found}; allowed: ${allowed}.` : (error as Error).message,
      line,
    );
  }
}
