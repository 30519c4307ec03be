#include "server/sim/carried.h"

#include <span>
#include <utility>

namespace clothlab::sim {

std::size_t Carried::bytes() const {
  std::size_t sum = numbers.size();
  for (const gl::Buffer& buffer : buffers) sum += buffer.bytes();
  return sum;
}

Carrier::Carrier(Carried* to, const Carried* from) : to_(to), from_(from) {
  constexpr std::size_t usual_numbers = 1024, usual_buffers = 12;
  if (!to_) return;
  to_->numbers.clear();
  to_->numbers.reserve(usual_numbers);
  to_->buffers.reserve(usual_buffers);
}

Carrier Carrier::to(Carried& copies) {
  return {&copies, nullptr};
}

Carrier Carrier::from(const Carried& copies) {
  return {nullptr, &copies};
}

Carrier::~Carrier() {
  if (to_) to_->buffers.resize(next_buffer_);  // of an earlier, longer list
}

void Carrier::buffer(gl::Buffer& buffer, std::size_t bytes) {
  const std::size_t at = next_buffer_++;
  if (to_) {
    if (at == to_->buffers.size()) to_->buffers.emplace_back();
    if (to_->buffers[at].bytes() != bytes) to_->buffers[at] = bytes > 0 ? gl::Buffer(bytes) : gl::Buffer();
    if (bytes > 0) to_->buffers[at].copy_from(buffer);
    return;
  }
  fits_ = fits_ && at < from_->buffers.size() && from_->buffers[at].bytes() == bytes;
  if (fits_ && bytes > 0) buffer.copy_from(from_->buffers[at]);
}

void Carrier::ring(gl::ReadbackRing& ring) {
  const std::span<const std::byte> seen = to_ ? ring.front(true) : std::span<const std::byte>();
  std::size_t bytes = seen.size();
  number(bytes);
  if (to_) {
    to_->numbers.insert(to_->numbers.end(), seen.begin(), seen.end());
    return;
  }
  while (!ring.empty()) ring.pop();
  fits_ = fits_ && next_number_ + bytes <= from_->numbers.size() && bytes <= ring.slot_bytes();
  if (!fits_ || bytes == 0) return;
  ring.push(gl::Buffer(bytes, from_->numbers.data() + next_number_), bytes);
  next_number_ += bytes;
}

void Carrier::raw(void* data, std::size_t bytes) {
  if (to_) {
    const auto* first = static_cast<const std::byte*>(data);
    to_->numbers.insert(to_->numbers.end(), first, first + bytes);
    return;
  }
  fits_ = fits_ && next_number_ + bytes <= from_->numbers.size();
  if (!fits_) return;
  std::memcpy(data, from_->numbers.data() + next_number_, bytes);
  next_number_ += bytes;
}

}  // namespace clothlab::sim
