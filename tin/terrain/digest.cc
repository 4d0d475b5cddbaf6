#include "tin/terrain/digest.h"

#include <array>
#include <bit>

namespace tin::terrain {
namespace {

/// A bijective scrambler of 64 bits with full avalanche (the finaliser of SplitMix64, Steele et al. 2014).
std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

std::uint64_t combine(std::uint64_t seed, std::uint64_t value) { return scramble(seed ^ scramble(value + 0x9e3779b97f4a7c15ULL)); }

struct Lanes {
  std::uint64_t low, high;
};

Lanes hash_vertex(exact::Point at, double z) {
  const std::uint64_t position =
      static_cast<std::uint64_t>(static_cast<std::uint32_t>(at.x)) << 32 | static_cast<std::uint32_t>(at.y);
  const auto elevation = std::bit_cast<std::uint64_t>(z + 0.0);  // -0 and 0 are one elevation
  return {combine(combine(0x74696e736d697468ULL, position), elevation),
          combine(combine(0x7665727465786573ULL, position), elevation)};
}

void append_hex(std::string& out, std::uint64_t value) {
  for (int shift = 60; shift >= 0; shift -= 4) out += "0123456789abcdef"[value >> shift & 15U];
}

std::uint64_t hash_text(std::uint64_t seed, const std::string& text) {
  for (const char c : text) seed = combine(seed, static_cast<unsigned char>(c));
  return combine(seed, text.size());
}

}  // namespace

void VertexSetHash::add(exact::Point at, double z) {
  const Lanes lanes = hash_vertex(at, z);
  low_ += lanes.low;
  high_ += lanes.high;
  ++count_;
}

void VertexSetHash::subtract(exact::Point at, double z) {
  const Lanes lanes = hash_vertex(at, z);
  low_ -= lanes.low;
  high_ -= lanes.high;
  --count_;
}

std::string VertexSetHash::digest(const frame::Frame& frame) const {
  std::array<std::uint64_t, 2> lanes{combine(low_, count_), combine(~high_, count_)};
  for (auto& lane : lanes) {
    lane = hash_text(lane, frame.crs);
    for (const frame::Axis* axis : {&frame.x, &frame.y}) {
      lane = combine(lane, std::bit_cast<std::uint64_t>(axis->origin));
      lane = combine(lane, std::bit_cast<std::uint64_t>(axis->unit));
      lane = combine(lane, static_cast<std::uint64_t>(axis->parts));
    }
    lane = combine(lane, std::bit_cast<std::uint64_t>(frame.vertical_unit_m));
  }
  std::string out;
  append_hex(out, lanes[0]);
  append_hex(out, lanes[1]);
  return out;
}

std::uint64_t fingerprint(const Change& change) {
  std::uint64_t hash = change.steps.size();
  const auto take = [&](const std::optional<Placement>& placement) {
    hash = placement ? combine(hash, hash_vertex(placement->at, placement->z).low) : combine(hash, 0);
  };
  for (const Step& step : change.steps) {
    hash = combine(hash, step.id.value());
    take(step.before);
    take(step.after);
  }
  return hash == 0 ? 1 : hash;
}

}  // namespace tin::terrain
