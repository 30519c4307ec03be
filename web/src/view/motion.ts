// How far a motion takes a point, for a camera that is to see all of it. Where something is at a time, the session
// says.
import { MathUtils, Vector3 } from "three";
import type { Motion, Vec3 } from "../link/scene_types";

/// Points that the motion of `home` [m] passes, its farthest among them; what leaves for good counts as still.
export function sweep(home: Vec3, motion: Motion): Vector3[] {
  const point = new Vector3(...home);
  if (motion && "oscillate" in motion && motion.oscillate.frequency > 0) {
    const way = new Vector3(...motion.oscillate.axis).normalize().multiplyScalar(motion.oscillate.amplitude);
    return [point, point.clone().add(way), point.clone().sub(way)];
  }
  if (motion && "spin" in motion && motion.spin.degrees_per_second !== 0) {
    const axis = new Vector3(...motion.spin.axis).normalize(),
      center = new Vector3(...motion.spin.center);
    return Array.from({ length: 12 }, (_, i) =>
      point
        .clone()
        .sub(center)
        .applyAxisAngle(axis, MathUtils.degToRad(30 * i))
        .add(center),
    );
  }
  return [point];
}
