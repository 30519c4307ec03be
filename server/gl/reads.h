// How kernels read buffers (shaders/access.glsl): as buffer textures or as storage buffers. Either way they
// read the same numbers; which is faster depends on the device.
#pragma once

namespace clothlab::gl {

enum class Reads { textures, storage };

/// The faster one on the device of the calling thread's current context, measured once (device_fact.h). All
/// contexts of a program are of one device. CLOTHLAB_READS=textures or storage in the environment decides
/// instead.
Reads fastest_reads();

/// Storage blocks that a compute program may have: 16, as NVIDIA allows no more, so that a program reads the
/// same way on each device; fewer if the device allows fewer, or CLOTHLAB_STORAGE_BLOCKS=N in the
/// environment, which plays such a device.
int most_storage_blocks();
/// Textures that a compute program may have: 32, or as many as the device allows, if that is less.
int most_textures();

/// Time of storage reads over that of texture reads, measured as shaders/reads.comp reads.
double storage_over_texture_reads();

}  // namespace clothlab::gl
