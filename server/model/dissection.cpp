#include "server/model/dissection.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>

namespace clothlab::model {

namespace {

/// Smaller sets are not divided: their matrix is nearly full in any order.
constexpr std::size_t indivisible = 4;

using Parts = std::span<const std::uint32_t>;

class Dissector {
 public:
  explicit Dissector(const std::vector<std::vector<std::uint32_t>>& neighbours)
      : neighbours_(neighbours), side_(neighbours.size(), nowhere) {
    made_.places.resize(neighbours.size());
  }

  Dissection dissected() {
    std::vector<std::uint32_t> all(neighbours_.size());
    for (std::uint32_t part = 0; part < all.size(); ++part) all[part] = part;
    divide(all);
    return std::move(made_);
  }

 private:
  static constexpr char nowhere = 0, in_left = 1, in_right = 2;

  /// Gives places to `parts`, which are in rising order. Returns the groups that have none above them yet.
  std::vector<std::size_t> divide(Parts parts) {
    if (parts.empty()) return {};
    const std::uint32_t first = next_;
    const Parts left = parts.first(parts.size() / 2), right = parts.subspan(left.size());
    mark(left, in_left);
    mark(right, in_right);
    const std::vector<std::uint32_t> of_left = beside(left, in_right), of_right = beside(right, in_left);
    mark(parts, nowhere);
    const bool cuts_left = of_left.size() <= of_right.size();
    const std::vector<std::uint32_t>& cut = cuts_left ? of_left : of_right;
    if (parts.size() <= indivisible || 2 * cut.size() >= parts.size()) return {group(parts, first, {})};
    std::vector<std::size_t> below = divide(cuts_left ? without(left, cut) : left);
    const std::vector<std::size_t> more = divide(cuts_left ? right : without(right, cut));
    below.insert(below.end(), more.begin(), more.end());
    if (cut.empty()) return below;
    return {group(cut, first, below)};
  }

  std::size_t group(Parts parts, std::uint32_t first, const std::vector<std::size_t>& below) {
    const std::size_t number = made_.groups.size();
    for (const std::size_t child : below) made_.groups[child].parent = static_cast<std::int32_t>(number);
    Dissection::Group made{first, next_};
    for (const std::uint32_t part : parts) made_.places[part] = next_++;
    made.end = next_;
    made_.groups.push_back(made);
    return number;
  }

  void mark(Parts parts, char side) {
    for (const std::uint32_t part : parts) side_[part] = side;
  }

  /// Those of `parts` that have a neighbour on the other side.
  std::vector<std::uint32_t> beside(Parts parts, char other) const {
    std::vector<std::uint32_t> found;
    std::copy_if(parts.begin(), parts.end(), std::back_inserter(found), [&](std::uint32_t part) {
      return std::any_of(neighbours_[part].begin(), neighbours_[part].end(),
                         [&](std::uint32_t neighbour) { return side_[neighbour] == other; });
    });
    return found;
  }

  /// Both in rising order.
  static std::vector<std::uint32_t> without(Parts parts, Parts cut) {
    std::vector<std::uint32_t> rest;
    std::set_difference(parts.begin(), parts.end(), cut.begin(), cut.end(), std::back_inserter(rest));
    return rest;
  }

  const std::vector<std::vector<std::uint32_t>>& neighbours_;
  std::vector<char> side_;
  Dissection made_;
  std::uint32_t next_ = 0;
};

}  // namespace

Dissection dissect(const std::vector<std::vector<std::uint32_t>>& neighbours) {
  return Dissector(neighbours).dissected();
}

}  // namespace clothlab::model
