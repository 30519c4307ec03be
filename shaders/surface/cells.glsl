// A spatial hash of triangles (Teschner et al. 2003), in levels by size: those of level k are at most 2^-k times as
// large as the largest, and lie, by their middle, in cells wide enough that whoever is no larger and near enough is in
// one of the 27 cells about its own.
const uint chain_end = 0xffffffffu;
const int last_level = 15;

int level_of(float radius) {
  float share = uintBitsToFloat(largest_triangle) / max(radius, 1e-30);
  return clamp(int(floor(log2(min(share, 1e6)))), 0, last_level);
}

float cell_width(int level) {
  return 1.001 * (reach_of(next_query()) + 2.0 * uintBitsToFloat(largest_triangle) * exp2(-float(level)));
}

ivec3 cell_of(vec3 x, float width) { return ivec3(floor(clamp(x / width, vec3(-1e9), vec3(1e9)))); }

uint bucket_of(ivec3 cell, int level) {
  uvec3 c = uvec3(cell);
  return (c.x * 73856093u ^ c.y * 19349663u ^ c.z * 83492791u ^ uint(level) * 2654435761u) & uint(CELL_COUNT - 1);
}
