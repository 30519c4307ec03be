// What a file is called that the page saves.

/// `seed-3.75s.png`: the scene's name without what a file's name may not have.
export function fileName(scene: string, time: number, ending: string): string {
  const name = scene.replace(/[^\p{Letter}\p{Number}._-]+/gu, "-").replace(/^[-.]+|-+$/g, "");
  return `${name || "cloth"}-${time.toFixed(2)}s.${ending}`;
}
