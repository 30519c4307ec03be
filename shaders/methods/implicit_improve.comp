// Implicit Euler, once per time step: adds to the first guess the combination of trends that makes its error the
// smallest in the norm of the matrix (Fischer 1998), in the residual, too. A trend that says nothing new is left out.
#include "implicit_euler.glsl"
#define SUMS_AT_ONCE TRENDS
#include "group_sums.glsl"
READ_VEC4(trends, unit_trends);
READ_VEC4(trend_products, unit_trend_products);
READ_VEC4(group_sums, unit_group_sums);
layout(std430, binding = slot_residual) buffer Residual { vec4 residual[]; };
layout(std430, binding = slot_guess) buffer Guess { vec4 guess[]; };
#include "implicit_total.glsl"

/// How much of each trend. `row`: see implicit_project.comp. Solves by L D L^T.
vec3 shares_of_trends(vec4 row[TRENDS]) {
  // Of a trend, what is new after those before it must be a ten-thousandth, which float32 has to a hundredth; and more
  // than nothing [J], as its inverse is needed.
  const float least = 1e-4, nothing = 1e-30;
  vec3 pivots = vec3(row[0].x, 0.0, 0.0), inverse = vec3(0.0);
  if (pivots.x > nothing) inverse.x = 1.0 / pivots.x;
  float l_10 = row[0].y * inverse.x, l_20 = row[0].z * inverse.x;
  pivots.y = row[1].y - l_10 * row[0].y;
  if (pivots.y > max(least * row[1].y, nothing)) inverse.y = 1.0 / pivots.y;
  float l_21 = (row[1].z - l_10 * row[0].z) * inverse.y;
  pivots.z = row[2].z - l_20 * row[0].z - l_21 * l_21 * pivots.y;
  if (pivots.z > max(least * row[2].z, nothing)) inverse.z = 1.0 / pivots.z;
  vec3 share = vec3(row[0].w, row[1].w, row[2].w);
  share.y -= l_10 * share.x;
  share.z -= l_20 * share.x + l_21 * share.y;
  share *= inverse;
  share.y -= l_21 * share.z;
  share.x -= l_10 * share.y + l_20 * share.z;
  return share;
}

void main() {
  vec4 row[TRENDS];
  read_totals(row);
  vec3 share = shares_of_trends(row);
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  if (FETCH(position, i).w == 0.0) return;
  vec3 more = vec3(0.0), product = vec3(0.0);
  for (int t = 0; t < TRENDS; ++t) {
    more += share[t] * FETCH(trends, TRENDS * i + t).xyz;
    product += share[t] * FETCH(trend_products, TRENDS * i + t).xyz;
  }
  guess[i].xyz += more;
  residual[i].xyz -= product;
}
