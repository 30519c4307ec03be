// The file of a mesh dropped on the page: uploaded, and hung up in place of the scene's first cloth. A scene's file
// goes to the scene's text.
import { content, hung, type Uploaded } from "../link/mesh_upload";
import { RpcError } from "../link/rpc";
import { notice, noticeError } from "./notices";
import type { Patch } from "../link/scene_types";

interface Host {
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  mayEdit(): boolean;
  refused(title: string, error: RpcError, patch: Patch): void;
  hung(): void; ///< the scene has another cloth
  scene(files: File[]): void; ///< one of these is a scene
}

const largestMessage = 8 * 1024 * 1024; // bytes: hello.limits.meshes.message_bytes
const longestName = 64;

function refused(title: string, line: string): void {
  notice("error", { title, lines: [line] });
}

async function take(file: File, host: Host): Promise<void> {
  if (!host.mayEdit()) return refused("Only operators may drop a mesh", "You are a viewer of this session.");
  if (!/\.(obj|ply|glb|gltf)$/i.test(file.name))
    return refused(
      `${file.name} is no mesh`,
      "The page takes .obj, .ply, .glb and .gltf files, and scenes as .json; other formats can be converted.",
    );
  const parameters = { name: file.name.slice(-longestName), ...content(new Uint8Array(await file.arrayBuffer())) };
  if (JSON.stringify(parameters).length + 200 > largestMessage)
    return refused(
      `${file.name} is too large`,
      "An upload may have 8 MiB. Larger files: start the server with --asset-root, and name the file in the scene.",
    );
  let patch: Patch | null = null;
  try {
    const mesh = await host.request<Uploaded>("mesh.upload", parameters);
    patch = hung(mesh);
    await host.request("scene.patch", { patch });
    host.hung();
    const triangles = `${mesh.vertices} vertices, ${mesh.triangles} triangles`;
    notice("info", { title: `${mesh.name} hangs`, lines: [`${triangles}. Its highest part is held.`] });
  } catch (error) {
    if (!(error instanceof RpcError)) return;
    const title = `${file.name} was refused`;
    if (patch) host.refused(title, error, patch);
    else noticeError(title, error);
  }
}

/// Takes files that are dropped anywhere on the page.
export function takeDroppedMeshes(host: Host): void {
  const carriesFile = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  window.addEventListener("dragover", (event) => {
    if (carriesFile(event)) event.preventDefault(); // else the browser would open the file
  });
  window.addEventListener("drop", (event) => {
    if (!carriesFile(event)) return;
    event.preventDefault();
    const files = [...(event.dataTransfer?.files ?? [])];
    if (files.some(({ name }) => /\.json$/i.test(name))) host.scene(files);
    else if (files[0]) void take(files[0], host);
  });
}
