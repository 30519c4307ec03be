// `RARELY(condition) { ... }` does what `if` does. Software OpenGL runs both sides of an `if` for every group of lanes,
// but skips a loop that no lane enters: for code that few vertices need, a loop that runs at most once is cheaper.
#define RARELY(condition) for (bool enter = (condition); enter; enter = false)
