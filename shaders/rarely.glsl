// `RARELY(condition) { ... }` does what `if` does, by a loop that runs at most once, for code that few items need.
// Software OpenGL runs both sides of an `if` for all items. Mesa 22.3's llvmpipe runs such a loop for all of them, too,
// and takes as long: code that is worth skipping must be a kernel of its own, over a list of the items that need it.
#define RARELY(condition) for (bool enter = (condition); enter; enter = false)
