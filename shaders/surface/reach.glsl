// Whether a pair may be nearer than `reach` [m]: a cheap test that most pairs fail, without their exact distance. No
// point of one part is nearer to the other than the parts are apart along any direction.
bool within_reach(bool edges, Corners c, float reach) {
  vec3 between = edges ? 0.5 * (c.x[0] + c.x[1] - c.x[2] - c.x[3]) : c.x[0] - (c.x[1] + c.x[2] + c.x[3]) / 3.0;
  return gap_along(edges, c, between) <= reach * length(between);
}
