// Finds how far a motion takes a point, so that a camera can show all of it. The session says where it is at a time.
import { MathUtils, Vector3 } from "three";
import type { Motion, Vec3 } from "../link/scene_types";

/// Points that the motion of `home` [m] passes, with the farthest ones. A velocity, which never returns, counts as
/// still.
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
