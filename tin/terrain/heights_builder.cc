#include "tin/terrain/heights_builder.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace tin::terrain {

namespace {

constexpr int kMostShift = 16, kShiftStep = 4;

template <class T>
bool fits(double value) {
  if constexpr (std::is_integral_v<T>) {
    return value >= double{std::numeric_limits<T>::min()} && value <= double{std::numeric_limits<T>::max()};
  } else {
    return std::abs(value) <= double{std::numeric_limits<T>::max()};
  }
}

/// The stored form of z; false when it would not give the same bits back.
template <class T>
bool to_stored(double z, int shift, T& out) {
  const double scaled = std::ldexp(z, shift);
  if (!fits<T>(scaled)) return false;
  out = static_cast<T>(scaled);
  return std::bit_cast<std::uint64_t>(std::ldexp(static_cast<double>(out), -shift)) ==
         std::bit_cast<std::uint64_t>(z);
}

constexpr std::size_t kAtOnce = base::kPaceBytes / sizeof(double);  // heights between two words about them

/// All values in another form; false, and nothing of worth in `to`, when one has none.
template <class From, class To>
bool convert(const base::Array<From>& from, int from_shift, base::Array<To>& to, int to_shift) {
  const base::Pace pace(to.get_allocator().memory());
  for (std::size_t i = 0; i < from.size(); ++i) {
    To stored{};
    if (!to_stored(std::ldexp(static_cast<double>(from[i]), -from_shift), to_shift, stored)) return false;
    to.push_back(stored);
    if (to.size() % kAtOnce == 0) pace.touched(2, kAtOnce * sizeof(To));
  }
  return true;
}

}  // namespace

HeightsBuilder::HeightsBuilder(std::size_t expected, std::pmr::memory_resource* memory)
    : expected_(expected), memory_(memory), pace_(memory) {
  base::Array<std::int16_t> narrow(memory_);
  narrow.reserve(expected);
  heights_.stored = std::move(narrow);
}

bool HeightsBuilder::try_add(double z) {
  return std::visit(
      [&](auto& values) {
        typename std::decay_t<decltype(values)>::value_type stored{};
        if (!to_stored(z, heights_.shift, stored)) return false;
        values.push_back(stored);
        return true;
      },
      heights_.stored);
}

/// The next form that holds what is there already: 16 bits; 32 bits in whole, 1/16, ... 1/65536 units; float;
/// double.
void HeightsBuilder::widen() {
  const auto with = [this]<class To>(To /*of which form*/, int shift) {
    base::Array<To> to(memory_);
    to.reserve(expected_);
    const bool all = std::visit([&](const auto& from) { return convert(from, heights_.shift, to, shift); },
                                heights_.stored);
    if (all) heights_ = {std::move(to), shift};
    return all;
  };
  if (std::holds_alternative<base::Array<std::int16_t>>(heights_.stored)) {
    with(std::int32_t{}, 0);
    return;
  }
  if (std::holds_alternative<base::Array<std::int32_t>>(heights_.stored)) {
    for (int shift = heights_.shift + kShiftStep; shift <= kMostShift; shift += kShiftStep) {
      if (with(std::int32_t{}, shift)) return;
    }
    if (with(float{}, 0)) return;
  }
  with(double{}, 0);
}

void HeightsBuilder::add(double z) {
  while (!try_add(z)) widen();
  note_one();
}

void HeightsBuilder::skip() {
  std::visit([](auto& values) { values.emplace_back(); }, heights_.stored);
  note_one();
}

void HeightsBuilder::note_one() {
  if (++since_noted_ < kAtOnce) return;
  pace_.touched(1, since_noted_ * sizeof(double));
  since_noted_ = 0;
}

}  // namespace tin::terrain
