// Poses of moving pins and colliders, and the wind, computed by the host in double precision for each step of a batch.
// A step has END_ROW rows after the row of its start: the last is its end, the one before it, if any, its middle.
// A pose takes five vec4: three rows (rotation, translation), the velocity of the origin, the angular velocity. The
// wind's velocity follows the poses of its row.
#if MOTION_COUNT > 0 || defined(WIND)
READ_VEC4(motion_table, unit_motion_table);
uniform int start_row;  // row of the step's start in the batch
#endif

#ifdef WIND
#define ROW_TEXELS (MOTION_COUNT * 5 + 1)
vec3 wind_velocity(int row) { return FETCH(motion_table, (start_row + row) * ROW_TEXELS + MOTION_COUNT * 5).xyz; }
#else
#define ROW_TEXELS (MOTION_COUNT * 5)
#endif

#if MOTION_COUNT > 0
int pose_at(int motion, int row) { return (start_row + row) * ROW_TEXELS + motion * 5; }

vec3 turned(int motion, int row, vec3 home) {
  int base = pose_at(motion, row);
  return vec3(dot(FETCH(motion_table, base).xyz, home), dot(FETCH(motion_table, base + 1).xyz, home),
              dot(FETCH(motion_table, base + 2).xyz, home));
}
vec3 placed(int motion, int row, vec3 home) {
  int base = pose_at(motion, row);
  return turned(motion, row, home) + vec3(FETCH(motion_table, base).w, FETCH(motion_table, base + 1).w,
                                          FETCH(motion_table, base + 2).w);
}
vec3 velocity_at(int motion, int row, vec3 where) {
  int base = pose_at(motion, row);
  return FETCH(motion_table, base + 3).xyz + cross(FETCH(motion_table, base + 4).xyz, where);
}
#else
vec3 turned(int motion, int row, vec3 home) { return home; }
vec3 placed(int motion, int row, vec3 home) { return home; }
vec3 velocity_at(int motion, int row, vec3 where) { return vec3(0.0); }
#endif
