// The strain limit of finite elements: a triangle whose warp or weft is too long is pulled together by moving its
// corners, each by its inverse mass and its share in the deformation gradient F. As with springs a pull acts along the
// thread's direction at the step's start, and begins the next step.
//
// Every corner computes its triangle's pulls for itself, from the same numbers in the same order: the results are the
// same to the last bit, so the triangle as a whole gets no momentum.

// For each vertex the corners at it, as triangle * 3 + corner; and the triangles: server/sim/thread_limit.h.
READ_UINT(first_corner, unit_first_corner);
READ_UINT(corners, unit_corners);
READ_UVEC4(limited_triangles, unit_limited_triangles);
/// For each of `corners`, written by its own vertex alone: impulses along warp and weft, times dt, 0 or more [kg m^2].
layout(std430, binding = slot_thread_pulls) buffer ThreadPulls { vec2 thread_pulls[]; };

struct LimitedTriangle {
  vec2 share[3];     // of each corner in F, along warp and weft [1/m]
  vec4 place[3];     // now; w: inverse mass [1/kg]
  vec3 start[3];     // at the step's start
  float relaxation;  // of its pulls
};

LimitedTriangle limited_triangle(int number) {
  uvec4 first = FETCH(limited_triangles, 2 * number), second = FETCH(limited_triangles, 2 * number + 1);
  LimitedTriangle t;
  t.relaxation = uintBitsToFloat(first.w);
  t.share[1] = uintBitsToFloat(second.xy);
  t.share[2] = uintBitsToFloat(second.zw);
  t.share[0] = -(t.share[1] + t.share[2]);
  for (int k = 0; k < 3; ++k) {
    t.place[k] = FETCH(position, first[k]);
    t.start[k] = FETCH(start_position, first[k]).xyz;
  }
  return t;
}

/// The thread along warp (0) or weft (1), which has length 1 at rest.
struct Thread {
  float size;
  vec3 direction;  // of a pull
  float growth;    // by a pull of 1 [1/(kg m^2)]
};

Thread thread_along(LimitedTriangle t, int along) {
  float own = t.share[0][along], first = t.share[1][along], second = t.share[2][along], growth;
  vec3 now = first * (t.place[1].xyz - t.place[0].xyz) + second * (t.place[2].xyz - t.place[0].xyz);
  vec3 before = first * (t.start[1] - t.start[0]) + second * (t.start[2] - t.start[0]);
  Thread thread;
  thread.size = length(now);
  thread.direction = pull_direction(now, before, growth);
  thread.growth =
      growth * (own * own * t.place[0].w + first * first * t.place[1].w + second * second * t.place[2].w);
  return thread;
}

/// Impulse on vertex i of the pulls at which the step before ended, times dt [kg m].
vec3 pulled_by_threads(int i) {
  vec3 moved = vec3(0.0);
  int end = int(FETCH_UINT(first_corner, i + 1));
  for (int at = int(FETCH_UINT(first_corner, i)); at < end; ++at) {
    vec2 pull = thread_pulls[at];
    RARELY(pull.x > 0.0 || pull.y > 0.0) {
      int number = int(FETCH_UINT(corners, at));
      LimitedTriangle t = limited_triangle(number / 3);
      vec2 moving = pull * t.share[number % 3];
      moved -= moving.x * thread_along(t, 0).direction + moving.y * thread_along(t, 1).direction;
    }
  }
  return moved;
}

/// Changes the pulls of the threads at vertex i. Adds their impulse on it to `moved` [kg m]; `most`: the largest error
/// that the sweep before left, as a share of the limit.
void sweep_threads(int i, vec2 limits, inout vec3 moved, inout float most) {
  int end = int(FETCH_UINT(first_corner, i + 1));
  for (int at = int(FETCH_UINT(first_corner, i)); at < end; ++at) {
    int number = int(FETCH_UINT(corners, at));
    LimitedTriangle t = limited_triangle(number / 3);
    vec2 pulls_now = thread_pulls[at], share = t.share[number % 3];
    bool pulled = false;
    for (int along = 0; along < 2; ++along) {
      Thread thread = thread_along(t, along);
      float pull = pulls_now[along], excess = thread.size - 1.0 - limits[along] * (1.0 - margin);
      RARELY((excess > 0.0 || pull > 0.0) && thread.growth > 0.0) {
        float changed = max(pull + t.relaxation * excess / thread.growth, 0.0);
        pulls_now[along] = changed;
        pulled = true;
        moved -= ((changed - pull) * share[along]) * thread.direction;
        // Remaining error: the thread is too long, or too short because of the pull.
        most = max(most, (changed > 0.0 ? abs(excess) : excess) / limits[along]);
      }
    }
    RARELY(pulled) thread_pulls[at] = pulls_now;
  }
}
