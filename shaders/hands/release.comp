// After a step: held vertices get their own mass back.
#include "hands.glsl"

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= held_count) return;
  position[held[i].vertex].w = held[i].numbers.z;
}
