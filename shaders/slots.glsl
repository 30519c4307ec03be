// Where things are bound, by name, for shaders and for C++ (slots.h): a `unit_` is a buffer that kernels read
// (access.glsl), a `slot_` a storage buffer, which they write. Behind a name stands who writes what is bound there, and
// after the semicolon who reads it. Names that no kernel needs at the same time may have the same number.

// Every kernel's.
const int unit_position = 0;             // the step before, or a method's own estimate; all
const int unit_velocity = 1;             // the same
const int unit_elements = 2;             // server/sim/element_lists.cpp; elements/lists.glsl
const int unit_element_slices = 3;       // the same
const int unit_neighbour_count = 4;      // collide/find_neighbours.comp; self-collision under every method
const int unit_neighbours = 5;           // collide/find_neighbours.comp, finish_lists.comp; the same
const int unit_motion_table = 6;         // server/sim/motion_table.cpp; methods/motions.glsl
const int unit_rest_position = 7;        // server/sim/simulation.cpp; pins, neighbour search, strain limit
const int unit_position_when_built = 8;  // collide/insert_cells.comp; methods/step_end.glsl
const int slot_next_position = 0;        // the end of a step, or of a part of it; the next one, as unit_position
const int slot_next_velocity = 1;        // the same, as unit_velocity
const int slot_neighbour_control = 2;    // collide/*.comp, methods/step_end.glsl; collide/*.comp, indirect dispatches

// The wind's, of every method; and of frames and pictures.
const int unit_fan_offsets = 24;  // server/model/fans.cpp; methods/wind.glsl, stream/normal.glsl
const int unit_fans = 25;         // the same

// The neighbour search's: collide/*.comp. The slots are read as the units of the same name, too.
const int unit_excluded = 9;             // server/sim/self_collision.cpp; find_neighbours
const int unit_first_excluded = 10;      // the same
const int unit_cell_heads = 11;          // insert_cells, finish_lists; find_neighbours
const int unit_cell_chains = 12;         // insert_cells; find_neighbours
const int slot_cell_heads = 3;           // insert_cells, finish_lists; insert_cells
const int slot_cell_chains = 4;          // insert_cells
const int slot_position_when_built = 5;  // insert_cells
const int slot_neighbour_count = 6;      // find_neighbours; finish_lists
const int slot_neighbours = 7;           // find_neighbours, finish_lists; both

// Verlet's: what a vertex carries from step to step.
const int unit_carried = 9;  // methods/verlet.comp; itself, in the next step
const int slot_carried = 3;

// The state at the step's start, for those whose unit_position is another: RK4, implicit Euler, the strain limit.
const int unit_start_position = 9;
const int unit_start_velocity = 10;

// RK4's: methods/rk4.comp, whose last stage reads the slopes that the others wrote.
const int unit_slope_1 = 11;
const int unit_slope_2 = 12;
const int unit_slope_3 = 13;
const int slot_slope = 3;

// Those of PBD, XPBD and VBD: methods/gauss_seidel.comp writes and reads the slots.
const int unit_deviation = 9;        // the pass before; methods/deviation.glsl
const int unit_visits = 10;          // PBD, XPBD: server/sim/gauss_seidel.cpp; methods/element_projection.glsl
const int unit_visited = 11;         // VBD: server/sim/gauss_seidel.cpp; methods/vertex_descent.glsl
const int unit_pushed = 11;          // XPBD: the sweep before; methods/element_projection.glsl
const int slot_deviation = 3;        // each pass; the next one, as unit_deviation
const int slot_pushed = 4;           // XPBD
const int slot_lacking = 4;          // VBD
const int slot_targets = 5;          // VBD
const int slot_velocity_before = 6;  // VBD
const int slot_remainders = 7;

// Implicit Euler's: methods/implicit_NAME.comp. The slots are read as the units of the same name, too.
const int unit_change = 11;             // update, or slot_guess; system, update, search, advance
const int unit_constraint = 12;         // start, advance; system, collect, multiply, precondition, update, end
const int unit_surface = 13;            // start, advance; end
const int unit_residual = 14;           // system, improve, update; project, collect, multiply, precondition, update,
                                        // advance, end
const int unit_preconditioned = 15;     // precondition, update; multiply, update
const int unit_direction = 16;          // update; update
const int unit_direction_product = 17;  // update; update
const int unit_product = 18;            // multiply; update
const int unit_group_sums = 19;         // project, search; improve, advance
const int unit_block_a = 20;            // system; precondition, update
const int unit_block_b = 21;            // system; precondition, update
const int unit_before_position = 22;    // the step before; end
const int unit_before_velocity = 23;    // the step before; system, end
const int unit_trends = 16;             // system; project, improve
const int unit_trend_products = 17;     // project; improve
const int unit_wind = 26;               // wind; start, system, multiply, search
const int unit_patch_lists = 27;        // server/sim/coarse_level.cpp; collect, multiply, step, precondition, update
const int unit_coarse_factor = 28;      // the same; step
const int unit_patch_sums = 29;         // collect, multiply; step
const int unit_coarse_vectors = 30;     // step; precondition, update
const int unit_history = 28;            // BDF2: bdf2_keep; start, bdf2_keep, bdf2_expect
const int slot_start_position = 0;      // start
const int slot_start_velocity = 1;      // start, advance; advance
const int slot_first_change = 2;        // start; as unit_change
const int slot_estimate = 3;            // start, advance, contacts; advance, and all as unit_velocity
const int slot_guess = 4;               // start, improve, advance; as unit_change
const int slot_constraint = 5;          // start, advance; advance
const int slot_surface = 6;             // start, advance; advance
const int slot_grip = 7;                // start, advance, end; the same
const int slot_residual = 0;            // system, improve, update
const int slot_preconditioned = 1;      // precondition, update
const int slot_block_a = 3;             // system
const int slot_block_b = 4;             // system
const int slot_trends = 5;              // system
const int slot_past_velocities = 6;     // system; itself, in the next step
const int slot_trend_products = 0;      // project
const int slot_product = 0;             // multiply
const int slot_group_sums = 1;          // project, search
const int slot_patch_sums = 7;          // collect, multiply
const int slot_coarse_vectors = 4;      // step; step
const int slot_solver_control = 3;      // step; update, indirect dispatches, conjugate_gradients.cpp
const int slot_direction = 4;           // update
const int slot_direction_product = 5;   // update
const int slot_change = 6;              // update
const int slot_wind = 0;                // wind
const int slot_history = 0;             // BDF2: bdf2_keep; as unit_history
const int slot_met = 1;                 // BDF2: bdf2_keep; server/sim/bdf2.cpp

// Contact between surfaces: surface/NAME.comp. The slots are read as the units of the same name, too.
const int unit_surface_triangles = 9;   // server/sim/surface_pairs.cpp; triangle_boxes
const int unit_triangle_boxes = 10;     // triangle_boxes; boxes, triangle_pairs, candidates
const int unit_expected = 34;           // triangle_boxes; neighbours, candidates, pairs, block_motions
const int unit_boxes = 11;              // boxes; leaf_pairs, bundle_pairs
const int unit_leaf_pairs = 12;         // leaf_pairs; bundle_pairs
const int unit_bundle_pairs = 9;        // bundle_pairs; triangle_pairs
const int unit_neighbour_pairs = 17;    // server/sim/surface_pairs.cpp; neighbours
const int unit_triangle_pairs = 13;     // triangle_pairs; candidates
const int unit_surface_pairs = 14;      // pairs, rest; cull, contacts
const int unit_near_pairs = 15;         // neighbours, candidates; pairs, and: contacts; forces, limit
const int unit_rest_places = 16;        // server/sim/surface_pairs.cpp; triangle_pairs
const int unit_step_start = 16;         // the step before, advance; path, cull, contacts, forces, begin
const int unit_step_velocity = 11;      // the step before; begin
const int unit_path = 17;               // path; advance
const int unit_step_target = 17;        // begin; limit, move
const int unit_step_limits = 10;        // limit, move; move
const int unit_body_places = 18;        // server/sim/surface_bodies.cpp; bodies, pairs, forces
const int unit_block_vertices = 10;     // server/sim/surface_blocks.cpp; block_motions
const int unit_block_motions = 11;      // block_motions; blocks
const int unit_vertex_contacts = 9;     // contacts, apply, limit; forces, apply, begin, limit, move
const int unit_contact_links = 10;      // contacts; apply
const int unit_contact_pushes = 11;     // forces; apply
const int unit_chosen_pairs = 12;       // cull, contacts; contacts, forces
const int unit_pair_loads = 13;         // contacts, forces; forces
const int slot_surface_control = 8;     // surface/*.comp; the same, indirect dispatches
const int slot_known_control = 0;       // the same buffer as a uniform block
const int slot_triangle_boxes = 3;      // triangle_boxes
const int slot_expected = 4;            // triangle_boxes
const int slot_block_motions = 3;       // block_motions
const int slot_boxes = 3;               // boxes
const int slot_leaf_pairs = 3;          // leaf_pairs
const int slot_bundle_pairs = 3;        // bundle_pairs
const int slot_triangle_pairs = 3;      // triangle_pairs
const int slot_surface_pairs = 3;       // pairs, rest; rest
const int slot_near_pairs = 3;          // neighbours, candidates, contacts, limit
const int slot_vertex_contacts = 4;     // contacts, apply, limit; begin, move
const int slot_contact_links = 6;       // contacts
const int slot_contact_pushes = 3;      // forces
const int slot_step_limits = 5;         // limit, move; the same
const int slot_pair_loads = 5;          // contacts, forces
const int slot_borne = 6;               // apply; apply
const int slot_step_target = 6;         // begin
const int slot_path = 6;                // path
const int slot_step_start = 5;          // advance
const int slot_chosen_pairs = 7;        // cull, contacts, limit; limit

// Contact as a term of the step's problem: surface/term_NAME.comp. The slots are read as the units of the same name.
const int unit_term_pairs = 31;      // pairs; friction, lists, and implicit Euler's methods/touching.glsl
const int unit_term_vertices = 32;   // lists; the same
const int unit_term_entries = 33;    // lists; the same
const int unit_term_way = 10;        // way; cull, limit, energy, friction, bodies, pairs, solids
const int unit_term_ends = 17;       // server/sim/surface_bodies.cpp; pairs, way
const int unit_term_start = 9;       // the step before; solids, limit_solids
const int unit_term_links = 10;      // pairs; ranks, lists
const int unit_term_ranks = 12;      // ranks; lists
const int unit_term_touched = 11;    // pairs; lists
const int unit_term_energies = 11;   // energy, friction; sum
const int slot_term_control = 1;     // surface/term_*.comp; the same, indirect dispatches, server/sim/contact_term.cpp
const int slot_known_term = 2;       // the same buffer; methods/implicit_search.comp, implicit_advance.comp
const int slot_term_chosen = 3;      // cull
const int slot_term_pairs = 3;       // pairs
const int slot_term_vertices = 4;    // pairs, lists
const int slot_term_entries = 5;     // lists
const int slot_term_links = 6;       // pairs
const int slot_term_touched = 7;     // pairs
const int slot_term_ranks = 3;       // ranks
const int slot_term_way = 3;         // way, hold
const int slot_term_target = 4;      // way; as unit_position of the pair search
const int slot_term_velocity = 5;    // way; as unit_velocity of the pair search
const int slot_term_energies = 3;    // energy, friction

// The hands': hands/NAME.comp, on the present copy of the state, just before a method's step and after it: what the
// neighbour search has bound for the method stays bound.
const int slot_held_position = 0;  // hold, release; all as unit_position
const int slot_held_velocity = 1;  // hold; all as unit_velocity
const int slot_held = 3;           // server/sim/hands.cpp; both

// The strain limit's: strain_limit/NAME.comp.
const int unit_group_excess = 10;        // sweep; the next sweep
const int unit_corrected_position = 11;  // sweep; end
const int unit_first_corner = 12;        // server/sim/thread_limit.cpp; sheet
const int unit_corners = 13;             // the same
const int unit_limited_triangles = 14;   // the same
const int slot_group_excess = 1;         // sweep; the next sweep, as unit_group_excess
const int slot_pulls = 3;                // sweep; sweep, and start in the next step
const int slot_limit_control = 4;        // sweep; indirect dispatches, server/sim/strain_limit.cpp
const int slot_given = 5;                // start, sweep; sweep, end
const int slot_thread_pulls = 6;         // as slot_pulls, of finite elements

// The diagnosis's.
const int slot_partials = 0;  // diagnose.comp; server/sim/diagnose.cpp

// Those of frames and pictures.
const int unit_places = 11;         // server/sim/scene_order.cpp; stream/scene_order.comp
const int slot_in_scene_order = 3;  // stream/scene_order.comp; as unit_position of stream/
const int slot_packed = 0;          // stream/pack.comp; server/stream/packer.cpp
const int slot_bounds = 2;          // stream/bounds.comp; stream/pack.comp
const int slot_field = 1;           // stream/field.comp; stream/pack.comp
const int slot_normals = 0;         // render/normals.comp; render/cloth.vert, as attribute_normal
const int unit_shadow_map = 0;      // render/depth.vert; render/light.glsl
const int block_frame = 0;          // a uniform block: server/render/renderer.cpp; render/frame.glsl

// Locations of a picture's attributes, and of uniforms of whichever program is in use: who reads them in render/.
const int attribute_position = 0;            // cloth.vert, placed.glsl
const int attribute_normal = 1;              // the same
const int attribute_texture_coordinate = 2;  // cloth.vert
const int uniform_placed = 0;                // placed.glsl
const int uniform_axes = 1;                  // the same
const int uniform_extent = 2;                // the same
const int uniform_point = 0;                 // plane.vert
const int uniform_normal = 1;                // plane.vert, plane.frag
const int uniform_color = 0;                 // cloth.frag
const int uniform_pattern = 1;               // cloth.frag

// All of them; with READ_STORAGE units are slots too, after the others.
const int number_of_units = 35;
const int number_of_slots = 9;
