// Finds where the camera stands so that everything it must show lies in the part of the window that no card covers.
import { MathUtils, type PerspectiveCamera, Vector3 } from "three";

/// The part of the window that cards leave free [CSS pixels].
export interface FreeArea {
  left: number;
  top: number;
  width: number;
  height: number;
}

// from the side: seen from the front, the seed's cloth hides its sphere
const viewFrom = new Vector3(1, 0.34, 0.5).normalize();
const right = new Vector3(0, 1, 0).cross(viewFrom).normalize();
const above = viewFrom.clone().cross(right);
// Slopes of a view's sides for which the farthest point is kept. Between them, one of the kept points is nearly the
// farthest.
const slopes = [0, 0.1, 0.25, 0.5];

/// The points that a camera must show: the farthest ones towards each side of a view in the direction `viewFrom`.
export class Outline {
  private readonly sides = slopes.flatMap((slope) =>
    [right, right.clone().negate(), above, above.clone().negate()].map((across) => ({
      along: across.clone().addScaledVector(viewFrom, slope),
      farthest: null as Vector3 | null,
      far: -Infinity,
    })),
  );

  get empty(): boolean {
    return this.sides[0]?.farthest === null;
  }

  add(points: Vector3[]): void {
    for (const side of this.sides) {
      for (const point of points) {
        const far = side.along.dot(point);
        if (far <= side.far) continue;
        side.far = far;
        side.farthest = point;
      }
    }
  }

  points(): Vector3[] {
    return this.sides.flatMap(({ farthest }) => (farthest ? [farthest] : []));
  }
}

/// Where a camera stands [m]: across and up the view, and away along it; `middle`: depth of the orbit's center.
export interface Stand {
  across: number;
  up: number;
  away: number;
  middle: number;
}

const padding = (area: FreeArea): number => 6 + 0.025 * Math.min(area.width, area.height); // [CSS pixels]

/// The nearest place from which every point of the outline falls into the area. `windowHeight` [CSS pixels], `fov`
/// [degrees].
export function standFor(outline: Outline, area: FreeArea, windowHeight: number, fov: number): Stand {
  const perPixel = Math.tan(MathUtils.degToRad(fov / 2)) / (windowHeight / 2);
  const tangent = (pixels: number): number => (perPixel * Math.max(pixels - 2 * padding(area), 24)) / 2;
  const wide = tangent(area.width);
  const high = tangent(area.height);
  const points = outline.points();
  // A point at depth z and at x to the right of the camera is inside while |x| < wide (away - z).
  const most = (along: Vector3, sign: number, slope: number): number =>
    Math.max(...points.map((point) => sign * along.dot(point) + slope * viewFrom.dot(point)));
  const [toRight, toLeft, toTop, toBottom] = [
    most(right, 1, wide),
    most(right, -1, wide),
    most(above, 1, high),
    most(above, -1, high),
  ];
  const depths = points.map((point) => viewFrom.dot(point));
  const nearest = Math.max(...depths);
  const away = Math.max((toRight + toLeft) / (2 * wide), (toTop + toBottom) / (2 * high), nearest + 0.05);
  return {
    across: (toRight - toLeft) / 2,
    up: (toTop - toBottom) / 2,
    away,
    middle: (nearest + Math.min(...depths)) / 2,
  };
}

/// Places the camera; returns the point it should orbit around.
export function place(camera: PerspectiveCamera, stand: Stand): Vector3 {
  const foot = new Vector3().addScaledVector(right, stand.across).addScaledVector(above, stand.up);
  camera.position.copy(foot).addScaledVector(viewFrom, stand.away);
  const distance = stand.away - stand.middle;
  camera.near = distance / 100;
  camera.far = distance * 40;
  camera.updateProjectionMatrix();
  return foot.addScaledVector(viewFrom, stand.middle);
}

/// The stand at `share` of the way between two stands.
export function between(from: Stand, to: Stand, share: number): Stand {
  const mix = (key: keyof Stand): number => from[key] + share * (to[key] - from[key]);
  return { across: mix("across"), up: mix("up"), away: mix("away"), middle: mix("middle") };
}

/// Shifts the picture so that its middle is the middle of the free area.
export function centerIn(camera: PerspectiveCamera, area: FreeArea, width: number, height: number): void {
  const x = width / 2 - (area.left + area.width / 2);
  const y = height / 2 - (area.top + area.height / 2);
  camera.aspect = width / height;
  camera.setViewOffset(width, height, x, y, width, height);
}
