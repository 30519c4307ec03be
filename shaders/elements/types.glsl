// Macros and types in which the element laws are written, for GLSL; elements.h defines them for C++.
#define real float
#define FUNCTION
#define PRECISE precise
#define OUT(T) out T
#define INOUT(T) inout T
#define UNUSED(name) name  // of a parameter
