// The memory of the process as one bound: what may become large is reserved before it is allocated, so that
// what does not fit is refused with its number, and nothing that is there is lost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "server/base/result.h"

namespace clothlab {

/// Any thread may use it.
class MemoryBudget : public std::enable_shared_from_this<MemoryBudget> {
 public:
  enum class Use { simulations, timelines, recordings, downloads };
  static constexpr std::size_t uses = 4;
  /// What the process takes without a scene, with its threads, the page and the driver's code [bytes].
  static constexpr std::uint64_t process_bytes = 112 << 20;
  /// The least total: it has room for a few small scenes [bytes].
  static constexpr std::uint64_t least_bytes = 256 << 20;

  /// What is reserved of it, until the end of its life. An empty one has no bytes, and of a null budget any.
  class Reservation {
   public:
    Reservation() = default;
    ~Reservation() { give_back(); }
    Reservation(Reservation&& other) noexcept { *this = std::move(other); }
    Reservation& operator=(Reservation&& other) noexcept;
    std::uint64_t bytes() const { return bytes_; }
    /// Makes it larger or smaller. Error as of `reserve`; it is as before then.
    Status resize(std::uint64_t bytes);

   private:
    friend class MemoryBudget;
    void give_back();
    std::shared_ptr<MemoryBudget> budget_;
    Use use_ = Use::simulations;
    std::uint64_t bytes_ = 0;
  };

  static std::shared_ptr<MemoryBudget> of(std::uint64_t total);

  /// Error: the bytes are more than the use's share or than is left of the total; it says what is needed,
  /// left and allowed. `budget` null: nothing is bounded.
  static Result<Reservation> reserve(const std::shared_ptr<MemoryBudget>& budget, Use use,
                                     std::uint64_t bytes);

  std::uint64_t total() const { return total_; }
  /// The most that a use may have: of what is left beside `process_bytes` simulations nine tenths, timelines
  /// (with what can be undone) and recordings a quarter each, downloads an eighth.
  std::uint64_t share(Use use) const;
  std::uint64_t used(Use use) const;
  std::uint64_t used() const;
  /// What a use may still have.
  std::uint64_t left(Use use) const;

 private:
  explicit MemoryBudget(std::uint64_t total) : total_(total) {}
  Status exchange(Use use, std::uint64_t before, std::uint64_t after);
  std::uint64_t left_locked(Use use) const;

  const std::uint64_t total_;
  mutable std::mutex mutex_;
  std::array<std::uint64_t, uses> used_{};
};

/// A text that gives back what is reserved for it when nobody has it any more.
std::shared_ptr<const std::string> held_text(std::string text, MemoryBudget::Reservation memory);

/// For people: "1.90 GB", "310 MB", of 10^9 and 10^6 bytes.
std::string memory_text(std::uint64_t bytes);

}  // namespace clothlab
