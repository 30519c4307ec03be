// A spatial hash: each cell leads to a chain of vertices. Teschner et al. 2003, "Optimized Spatial Hashing", section
// 3.1.
uniform int vertex_count;
uniform float reach;  // contact distance + skin; a cell is twice as wide [m]

const uint chain_end = 0xffffffffu;

vec3 in_cells(vec3 x) { return clamp(x * (0.5 / reach), vec3(-1e9), vec3(1e9)); }
ivec3 cell_of(vec3 x) { return ivec3(floor(in_cells(x))); }
/// The lowest of the eight cells that a ball of radius `reach` about x can touch.
ivec3 corner_of(vec3 x) { return ivec3(floor(in_cells(x) - 0.5)); }

uint bucket_of(ivec3 cell) {
  uvec3 c = uvec3(cell);
  return (c.x * 73856093u ^ c.y * 19349663u ^ c.z * 83492791u) & uint(CELL_COUNT - 1);
}
