#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace tests::fuzz {
namespace {

using Random = std::mt19937_64;

constexpr std::array<std::string_view, 24> kTokens = {
    "0",    "-1", "1e308", "1e-400",  "nan",  "inf", "9223372036854775808", "18446744073709551616",
    "\r\n", "\n", "\"",    "\\u0000", "{",    "}",   "[[[[[[[[[[[[[[[[",    "]",
    ",",    ":",  ";",     "\xff",    "\xc3", "\t",  "0x7fffffff",          " "};
constexpr std::array<std::uint64_t, 10> kEdges = {0,      1,      0x7f,       0x80,       0xff,
                                                  0x7fff, 0xffff, 0x7fffffff, 0xffffffff, 0x7fffffffffffffff};

std::size_t below(Random& random, std::size_t bound) {
  return bound == 0 ? 0 : static_cast<std::size_t>(random() % bound);
}

void flip_bit(std::string& s, Random& random) {
  if (s.empty()) return;
  s[below(random, s.size())] ^= static_cast<char>(1U << below(random, 8));
}

void set_byte(std::string& s, Random& random) {
  if (!s.empty()) s[below(random, s.size())] = static_cast<char>(random());
}

void cut(std::string& s, Random& random) {
  const std::size_t at = below(random, s.size() + 1);
  const bool tail = below(random, 4) == 0;
  s.erase(at, tail ? std::string::npos : 1 + below(random, 16));
}

void repeat(std::string& s, Random& random) {
  const std::size_t at = below(random, s.size() + 1);
  const std::string piece = s.substr(at, 1 + below(random, 64));
  const std::size_t times = below(random, 8) == 0 ? 200 : 1 + below(random, 3);
  std::string many;
  for (std::size_t i = 0; i < times; ++i) many += piece;
  s.insert(at, many);
}

void move_piece(std::string& s, Random& random) {
  const std::size_t at = below(random, s.size() + 1);
  const std::string piece = s.substr(at, 1 + below(random, 32));
  s.erase(at, piece.size());
  s.insert(below(random, s.size() + 1), piece);
}

void put_token(std::string& s, Random& random) {
  const std::string_view token = kTokens[below(random, kTokens.size())];
  const std::size_t at = below(random, s.size() + 1);
  s.replace(at, below(random, 2) == 0 ? 0 : token.size(), token);
}

void put_edge(std::string& s, Random& random) {
  const std::size_t width = std::size_t{1} << below(random, 4);
  if (s.size() < width) return;
  const std::uint64_t value = kEdges[below(random, kEdges.size())] + below(random, 3) - 1;
  const std::size_t at = below(random, s.size() - width + 1);
  for (std::size_t i = 0; i < width; ++i) s[at + i] = static_cast<char>(value >> (8 * i));
}

void splice(std::string& s, const std::vector<std::string>& seeds, Random& random) {
  const std::string& other = seeds[below(random, seeds.size())];
  const std::size_t from = below(random, other.size() + 1);
  s.replace(below(random, s.size() + 1), below(random, 2) == 0 ? 0 : std::string::npos,
            other.substr(from, 1 + below(random, 256)));
}

}  // namespace

std::string mutate(std::string input, const std::vector<std::string>& seeds, std::mt19937_64& random,
                   std::size_t most) {
  const std::size_t changes = std::size_t{1} << below(random, 4);
  for (std::size_t i = 0; i < changes; ++i) {
    switch (below(random, 8)) {
      case 0:
        flip_bit(input, random);
        break;
      case 1:
        set_byte(input, random);
        break;
      case 2:
        cut(input, random);
        break;
      case 3:
        repeat(input, random);
        break;
      case 4:
        move_piece(input, random);
        break;
      case 5:
        put_token(input, random);
        break;
      case 6:
        put_edge(input, random);
        break;
      default:
        splice(input, seeds, random);
        break;
    }
    if (input.size() > most) input.resize(most);
  }
  return input;
}

}  // namespace tests::fuzz
