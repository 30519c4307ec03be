// A target needs a source to precompile its headers for.
#include "tests/headers.h"
