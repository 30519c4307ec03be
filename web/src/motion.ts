// Where a moving collider is at a simulated time, by the formulas of contract.md.
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

/// How far a motion may take a point from home [m]; what has no bound counts as 0.
export function reach(motion: Motion): number {
  return motion && "oscillate" in motion ? Math.abs(motion.oscillate.amplitude) : 0;
}
