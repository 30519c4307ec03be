// The mode that grows, from places at moments a step apart: the vibration of the highest frequency changes its side at
// each step, so the second difference of the places is four times its amplitude, while what the cloth does besides
// contributes its acceleration times the square of the step alone.
import { decodePlaces } from "../view/places";
import { fieldBytes, q16Words, type Frame, type ShownFrame } from "../link/protocol";

const headerBytes = 64;
const placeBytes = 8; // of a q16 frame, a vertex
const least = 2e-4; // of the frame's largest side: less is rounding of q16 and the motion itself

const placesOf = (frame: Frame): Float32Array => {
  const places = new Float32Array(3 * frame.header.vertexCount);
  decodePlaces({ header: frame.header, words: q16Words(frame) }, places);
  return places;
};

/// How far each vertex swings in the mode, as shares of the one that swings most; 0 where nothing can be told.
export function swing(before: Float32Array, middle: Float32Array, after: Float32Array, noise: number): Float32Array {
  const far = new Float32Array(after.length / 3);
  for (let i = 0; i < far.length; ++i) {
    let sum = 0;
    for (let axis = 3 * i; axis < 3 * i + 3; ++axis)
      sum += ((before[axis] as number) - 2 * (middle[axis] as number) + (after[axis] as number)) ** 2;
    far[i] = Math.sqrt(sum) / 4;
  }
  const most = far.reduce((a, b) => Math.max(a, b), noise);
  return far.map((each) => each / most);
}

/// The frames, coloured by the growing mode.
export function coloured(frames: ShownFrame[]): ShownFrame[] {
  const places = frames.map(placesOf);
  return frames.map((frame, i) => {
    const [before, middle, after] = [places[i - 2], places[i - 1], places[i]];
    const noise = least * Math.max(...frame.header.boxExtent);
    const shares = before && middle && after ? swing(before, middle, after, noise) : null;
    const { vertexCount } = frame.header;
    const bytes = headerBytes + placeBytes * vertexCount;
    const buffer = new ArrayBuffer(bytes + vertexCount);
    new Uint8Array(buffer).set(new Uint8Array(frame.buffer, 0, bytes));
    const shown: ShownFrame = { ...frame, buffer, header: { ...frame.header, range: 1 }, field: "growth" };
    const field = fieldBytes(shown);
    shares?.forEach((share, vertex) => {
      if (field) field[vertex] = Math.round(255 * share);
    });
    return shown;
  });
}
