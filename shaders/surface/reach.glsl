// Whether a pair may be nearer than `reach` [m] where its corners are, at c, or on their straight ways to `ahead`: a
// cheap test that most pairs fail, without their exact distance. No point of one part is nearer to the other than the
// gap between both along any direction, which is on the way never less than the lesser of those at its ends.
bool within_reach(bool edges, Corners c, Corners ahead, float reach) {
  vec3 between = edges ? 0.5 * (c.x[0] + c.x[1] - c.x[2] - c.x[3]) : c.x[0] - (c.x[1] + c.x[2] + c.x[3]) / 3.0;
  return min(gap_along(edges, c, between), gap_along(edges, ahead, between)) <= reach * length(between);
}
