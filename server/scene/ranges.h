// Every range and limit of the scene document. scene.schema.json has the same numbers; tests/schema checks
// that both accept and refuse the same values at each end of each range. All ends are inclusive, and as a
// float32 each is finite and either 0 or normal.
#pragma once

#include <cstddef>

namespace clothlab::scene {

struct Range {
  double minimum, maximum;
  const char* unit = "";
};

namespace ranges {

inline constexpr Range position{-1e6, 1e6, "m"};  ///< a coordinate
inline constexpr Range length{1e-6, 1e6, "m"};    ///< a width, a height, a radius
inline constexpr Range velocity{-1e6, 1e6, "m/s"};
inline constexpr Range gravity{-1e6, 1e6, "m/s^2"};
inline constexpr Range angle{-1e6, 1e6, "degrees"};
inline constexpr Range angular_speed{-1e6, 1e6, "degrees/s"};
inline constexpr Range direction{-1e6, 1e6};  ///< one component; the three are not all 0
inline constexpr Range amplitude{-1e6, 1e6, "m"};
inline constexpr Range frequency{0, 1e4, "Hz"};

inline constexpr Range grid_count{2, 1024, "vertices"};
inline constexpr Range scale{1e-6, 1e6};
inline constexpr Range mass_per_vertex{1e-9, 1e6, "kg"};
inline constexpr Range area_density{1e-9, 1e6, "kg/m^2"};
inline constexpr Range weight{1e-9, 1e6, "kg"};  ///< added to a vertex
inline constexpr Range stiffness{0, 1e12, "N/m"};
inline constexpr Range damping{0, 1e9, "N s/m"};
inline constexpr Range strain_limit{1e-3, 10, "of the rest length; or null"};
inline constexpr Range modulus{1e-3, 1e9, "N/m"};  ///< of pulling a sheet along its threads
inline constexpr Range shear_modulus{0, 1e9, "N/m"};
inline constexpr Range poisson{-10, 10};  ///< besides, poisson^2 < warp / weft
inline constexpr Range bending{0, 1e6, "N m"};
inline constexpr Range damping_time{0, 10, "s"};

inline constexpr Range start_scale{-1e3, 1e3};
inline constexpr Range seed{0, 1e9};
inline constexpr Range dress{1e-3, 10, "s"};

inline constexpr Range friction{0, 10};
inline constexpr Range restitution{0, 1};
inline constexpr Range thickness{1e-6, 10, "m"};
inline constexpr Range wind_speed{-1e3, 1e3, "m/s"};  ///< along an axis
inline constexpr Range gust{0, 10, "of the wind's velocity"};
inline constexpr Range air_coefficient{0, 100};  ///< of drag or lift
inline constexpr Range air_drag{0, 1e6, "1/s"};

inline constexpr Range key_time{0, 1e9, "s"};

inline constexpr Range dt{1e-9, 1, "s"};
inline constexpr Range iterations{1, 10000};
inline constexpr Range tolerance{1e-12, 1};

}  // namespace ranges

inline constexpr std::size_t max_name_length = 64;  ///< characters, not bytes
inline constexpr std::size_t max_cloths = 64;
inline constexpr std::size_t max_colliders = 64;
inline constexpr std::size_t max_pins = 1024;     ///< of one cloth
inline constexpr std::size_t max_weights = 1024;  ///< of one cloth
inline constexpr std::size_t max_panel_holes = 64;
inline constexpr std::size_t max_panel_edges = 256;  ///< named runs
inline constexpr std::size_t max_keys = 1024;
inline constexpr std::size_t max_keyframes = 4096;     ///< of one key
inline constexpr std::size_t max_vertices = 1u << 20;  ///< of the whole scene
inline constexpr std::size_t max_triangles = 1u << 21;
inline constexpr std::size_t max_body_vertices = 200'000;  ///< of all bodies of triangles together
inline constexpr std::size_t max_body_triangles = 200'000;

}  // namespace clothlab::scene
