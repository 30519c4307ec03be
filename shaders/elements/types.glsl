// The words in which the element laws are written, for GLSL. elements.h gives them their meaning in C++.
#define real float
#define FUNCTION
#define PRECISE precise
#define OUT(T) out T
#define INOUT(T) inout T
