// Where a moving collider is at a simulated time, by the formulas of server/scene/README.md.
import { MathUtils, Vector3 } from "three";
import type { Motion, Vec3 } from "./scene_types";

/// Moves the point `home` [m] to where it is at `time` [s].
export function moved(home: Vec3, motion: Motion, time: number): Vector3 {
  const point = new Vector3(...home);
  if (!motion) return point;
  if ("oscillate" in motion) {
    const { axis, amplitude, frequency } = motion.oscillate;
    return point.addScaledVector(new Vector3(...axis).normalize(), amplitude * Math.sin(2 * Math.PI * frequency * time));
  }
  if ("linear" in motion) return point.addScaledVector(new Vector3(...motion.linear.velocity), time);
  const { axis, center, degrees_per_second } = motion.spin;
  const about = new Vector3(...center);
  return point.sub(about).applyAxisAngle(new Vector3(...axis).normalize(), MathUtils.degToRad(degrees_per_second * time)).add(about);
}

/// Times [s] at which a motion is farthest from home, one period long; what leaves for good counts as still.
export function extremes(motion: Motion): number[] {
  if (motion && "oscillate" in motion && motion.oscillate.frequency > 0) {
    return [0, 0.25 / motion.oscillate.frequency, 0.75 / motion.oscillate.frequency];
  }
  if (motion && "spin" in motion && motion.spin.degrees_per_second !== 0) {
    return Array.from({ length: 12 }, (_, i) => (i * 30) / Math.abs(motion.spin.degrees_per_second));
  }
  return [0];
}
