// `--shard i/n`: a share of the work, so that several machines can do it.
#pragma once

#include <cstddef>
#include <string>

#include "server/base/result.h"

namespace clothlab::cli {

/// Every `of`-th piece of the work, from the `number`-th on, counted from 1.
struct Shard {
  std::size_t number = 1, of = 1;
};

/// Reads "i/n". Error: it is not that, or i is not from 1 to n.
Result<Shard> shard_of(const std::string& text);

}  // namespace clothlab::cli
