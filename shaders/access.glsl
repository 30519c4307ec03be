// Reading of buffers: through a buffer texture, or with READ_STORAGE from a storage buffer, whichever is faster on the
// device (server/gl/reads.h; on Mesa's llvmpipe a texture takes less than half the time). Writes always go to storage
// buffers. Use: READ_VEC4(position, unit_position); ... vec4 p = FETCH(position, i);
#include "slots.glsl"
#ifdef READ_STORAGE
#define READ_BUFFER_(type, name, unit) \
  layout(std430, binding = number_of_slots + unit) readonly buffer name##_reads { type name[]; }
#define READ_VEC4(name, unit) READ_BUFFER_(vec4, name, unit)
#define READ_UVEC4(name, unit) READ_BUFFER_(uvec4, name, unit)
#define READ_UVEC2(name, unit) READ_BUFFER_(uvec2, name, unit)
#define READ_UINT(name, unit) READ_BUFFER_(uint, name, unit)
#define FETCH(name, i) name[i]
#define FETCH_UVEC2(name, i) name[i]
#define FETCH_UINT(name, i) name[i]
#else
#define READ_VEC4(name, unit) layout(binding = unit) uniform samplerBuffer name
#define READ_UVEC4(name, unit) layout(binding = unit) uniform usamplerBuffer name
#define READ_UVEC2(name, unit) layout(binding = unit) uniform usamplerBuffer name
#define READ_UINT(name, unit) layout(binding = unit) uniform usamplerBuffer name
#define FETCH(name, i) texelFetch(name, int(i))
#define FETCH_UVEC2(name, i) texelFetch(name, int(i)).xy
#define FETCH_UINT(name, i) texelFetch(name, int(i)).x
#endif
