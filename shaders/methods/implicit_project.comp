// Implicit Euler, once per time step: the matrix times each trend of the motion, and the sums from which
// implicit_improve.comp finds the combination of trends that is nearest to the solution.
#include "implicit_euler.glsl"
#define SUMS_AT_ONCE TRENDS
#include "group_sums.glsl"
#include "touching.glsl"
READ_VEC4(residual, unit_residual);
READ_VEC4(trends, unit_trends);
layout(std430, binding = slot_trend_products) writeonly buffer Products { vec4 trend_products[]; };
layout(std430, binding = slot_group_sums) writeonly buffer Sums { vec4 group_sums[]; };  // TRENDS per work group

void multiply(int i, vec4 x, vec3 trend[TRENDS], out vec3 product[TRENDS]) {
  for (int t = 0; t < TRENDS; ++t) product[t] = trend[t] * ((1.0 + dt * drag(i)) / x.w);
#each Law
  for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
    LawEntry entry = entry_of_Law(at.first);
    LawEdges dx, edges;
    for (int k = 0; k < Law_CORNERS - 1; ++k) dx.d[k] = x.xyz - FETCH(position, entry.others[k]).xyz;
    LawMatrix matrix = step_matrix(element_hessian(entry.law, dx), dt);
    for (int t = 0; t < TRENDS; ++t) {
      for (int k = 0; k < Law_CORNERS - 1; ++k)
        edges.d[k] = trend[t] - FETCH(trends, TRENDS * entry.others[k] + t).xyz;
      product[t] += matrix_product(matrix, edges);
    }
  }
#end
#define TREND(j) FETCH(trends, TRENDS * int(j) + t).xyz
  for (int t = 0; t < TRENDS; ++t) ADD_TOUCHES(i, TREND, product[t])
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  // In row t: the products of trend t with the matrix times it and times the later ones, and last with the residual.
  vec4 rows[TRENDS] = vec4[](vec4(0.0), vec4(0.0), vec4(0.0));
  vec4 x = i < vertex_count ? FETCH(position, i) : vec4(0.0);
  if (x.w > 0.0) {
    vec3 trend[TRENDS], product[TRENDS], r = FETCH(residual, i).xyz;
    for (int t = 0; t < TRENDS; ++t) trend[t] = FETCH(trends, TRENDS * i + t).xyz;
    multiply(i, x, trend, product);
    for (int t = 0; t < TRENDS; ++t) {
      for (int later = t; later < TRENDS; ++later) rows[t][later] = dot(trend[t], product[later]);
      rows[t].w = dot(trend[t], r);
      trend_products[TRENDS * i + t] = vec4(product[t], 0.0);
    }
  }
  sums_of_group(rows, false);
  if (gl_LocalInvocationID.x == 0)
    for (int t = 0; t < TRENDS; ++t) group_sums[TRENDS * gl_WorkGroupID.x + t] = rows[t];
}
