// What a linked program uses: where its buffers are bound, and whether it may write into them.
#pragma once

#include <glad/gl.h>

#include <string>
#include <vector>

namespace clothlab::gl {

struct ProgramUse {
  enum class Kind { storage, uniform, texture };
  Kind kind = Kind::storage;
  GLuint place = 0;     ///< the number of the storage or uniform block's binding, or of the texture unit
  bool writes = false;  ///< a storage block without `readonly`
  std::string name;     ///< "storage block Limits"
};

/// Of a program that has been linked from these texts: by reflection, which does not tell `readonly`; that is
/// read in the texts.
std::vector<ProgramUse> uses_of(GLuint program, const std::string& texts);

}  // namespace clothlab::gl
