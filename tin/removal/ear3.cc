#include "tin/removal/ear3.h"

#include <cstdint>

namespace tin::removal {
namespace {

/// Three to five corners, by the paper's decision tree.
template <class Tally>
class Few {
 public:
  Few(const Star& star, Ear* out, Tally& tally) : star_(star), out_(out), tally_(tally) {}

  void fill_star() {
    if (star_.degree() == 3) return put(Ear{0, 1, 2});
    if (star_.degree() == 5) return pentagon(0, 1, 2, 3, 4);
    if (holds(0, 1, 2, 3)) return put(Ear{1, 2, 3}, Ear{0, 1, 3});
    put(Ear{0, 1, 2}, Ear{0, 2, 3});
  }

  /// e is put into the triangulation of the other four: it sees the triangle on da, and perhaps the other
  /// one.
  void pentagon(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint32_t e) {
    if (holds(a, b, c, d)) {
      if (!holds(a, b, d, e)) return put(Ear{b, c, d}, Ear{a, b, d}, Ear{a, d, e});
      if (!holds(b, c, d, e)) return put(Ear{b, c, d}, Ear{b, d, e}, Ear{a, b, e});
    } else {
      if (!holds(a, c, d, e)) return put(Ear{a, b, c}, Ear{a, c, d}, Ear{a, d, e});
      if (!holds(a, b, c, e)) return put(Ear{a, b, c}, Ear{c, d, e}, Ear{a, c, e});
    }
    put(Ear{c, d, e}, Ear{b, c, e}, Ear{a, b, e});
  }

 private:
  bool holds(std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
    return star_.in_conflict(i, j, k, l, tally_);
  }
  template <class... More>
  void put(const Ear& ear, const More&... more) {
    *out_++ = ear;
    if constexpr (sizeof...(more) > 0) put(more...);
  }

  const Star& star_;
  Ear* out_;
  Tally& tally_;
};

}  // namespace

template <class Tally>
std::span<const Ear> Ear3::fill(const Star& star, Tally& tally) {
  queue_.run(star, 3, tally);
  return queue_.ears();
}

template <class Tally>
std::span<const Ear> Ear5::fill(const Star& star, Tally& tally) {
  if (star.degree() <= 5) {
    Few<Tally>(star, few_.data(), tally).fill_star();
    return std::span(few_).first(star.degree() - 2);
  }
  queue_.run(star, 5, tally);
  auto& ears = queue_.ears();
  if (const auto left = queue_.remains(); !left.empty()) {
    ears.resize(ears.size() + 3);
    Few<Tally>(star, &ears[ears.size() - 3], tally).pentagon(left[0], left[1], left[2], left[3], left[4]);
  }
  return ears;
}

template std::span<const Ear> Ear3::fill(const Star&, NoCounters&);
template std::span<const Ear> Ear3::fill(const Star&, Counters&);
template std::span<const Ear> Ear5::fill(const Star&, NoCounters&);
template std::span<const Ear> Ear5::fill(const Star&, Counters&);

}  // namespace tin::removal
