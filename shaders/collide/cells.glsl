// A spatial hash: cell -> a chain of vertices. Teschner et al. 2003, "Optimized Spatial Hashing", section 3.1.
layout(location = 0) uniform int vertex_count;
layout(location = 2) uniform float reach;  // contact distance + skin, also the cell's edge [m]

const uint chain_end = 0xffffffffu;

ivec3 cell_of(vec3 x) { return ivec3(floor(clamp(x / reach, vec3(-1e9), vec3(1e9)))); }

uint bucket_of(ivec3 cell) {
  uvec3 c = uvec3(cell);
  return (c.x * 73856093u ^ c.y * 19349663u ^ c.z * 83492791u) & uint(CELL_COUNT - 1);
}
