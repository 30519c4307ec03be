#include "server/base/pieces.h"

#include <utility>

namespace clothlab {

namespace {

thread_local std::function<void()> watch_of_thread;
thread_local int may_give_up_count = 0, whole_count = 0;

}  // namespace

void between_pieces() {
  if (watch_of_thread) watch_of_thread();
}

PieceWatch::PieceWatch(std::function<void()> watch) {
  watch_of_thread = std::move(watch);
}
PieceWatch::~PieceWatch() {
  watch_of_thread = nullptr;
}

MayGiveUp::MayGiveUp() {
  ++may_give_up_count;
}
MayGiveUp::~MayGiveUp() {
  --may_give_up_count;
}

Whole::Whole() {
  ++whole_count;
}
Whole::~Whole() {
  --whole_count;
}

bool may_give_up() {
  return may_give_up_count > 0 && whole_count == 0;
}

}  // namespace clothlab
