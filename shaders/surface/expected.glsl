// What a search expects of each vertex, as two texels, which triangle_boxes.comp writes: its place at the search, and
// how far it goes at its velocity in the time that the search looks ahead [m].
READ_VEC4(expected, unit_expected);

vec3 place_at_search(uint vertex) { return FETCH(expected, 2u * vertex).xyz; }
vec3 expected_motion(uint vertex) { return FETCH(expected, 2u * vertex + 1u).xyz; }
