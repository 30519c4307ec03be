// Colours of the lines: light over dark cloth, dark over light cloth.
import { Color } from "three";
import type { SceneDocument } from "../link/scene_types";

export type LineKind = "wireframe" | "normals" | "structural" | "shear" | "bend" | "elements";
interface Look {
  colour: string;
  opacity: number;
}

const overDark: Record<LineKind, Look> = {
  wireframe: { colour: "#ffffff", opacity: 0.42 },
  normals: { colour: "#ffffff", opacity: 0.85 },
  structural: { colour: "#fff3c4", opacity: 0.75 },
  shear: { colour: "#7ee0ff", opacity: 0.7 },
  bend: { colour: "#b8ff9e", opacity: 0.6 },
  elements: { colour: "#fff3c4", opacity: 0.75 },
};
const overLight: Record<LineKind, Look> = {
  wireframe: { colour: "#000000", opacity: 0.42 },
  normals: { colour: "#000000", opacity: 0.75 },
  structural: { colour: "#5a3a00", opacity: 0.75 },
  shear: { colour: "#00466b", opacity: 0.7 },
  bend: { colour: "#1d5a00", opacity: 0.6 },
  elements: { colour: "#5a3a00", opacity: 0.75 },
};

/// By the mean lightness of the scene's cloths.
export function tonesFor({ cloths }: SceneDocument): Record<LineKind, Look> {
  const lightness = cloths.map(({ color }) => new Color(color).getHSL({ h: 0, s: 0, l: 0 }).l);
  return lightness.reduce((sum, one) => sum + one, 0) > 0.62 * lightness.length ? overLight : overDark;
}

/// Of what is stretched and compressed, as shares of sRGB.
export const stretched = [1, 0.87, 0.25] as const;
export const compressed = [0.3, 0.85, 1] as const;
