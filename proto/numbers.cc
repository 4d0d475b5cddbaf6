#include "proto/numbers.h"

#include <charconv>
#include <cmath>

#include "tin/base/check.h"

namespace proto {
namespace {

constexpr double kPowers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
constexpr std::uint64_t kIntegerPowers[] = {1,      10,      100,      1000,      10000,
                                            100000, 1000000, 10000000, 100000000, 1000000000};
constexpr std::size_t kLongestNumber = 40;

}  // namespace

void append_integer(std::string& out, std::uint64_t value) {
  char buffer[kLongestNumber];
  const auto written = std::to_chars(buffer, buffer + sizeof buffer, value);
  out.append(buffer, written.ptr);
}

void append_shortest(std::string& out, double value) {
  TIN_DCHECK(std::isfinite(value));
  const double size = std::fabs(value);
  if (size == 0) {
    out += '0';
    return;
  }
  const bool plain = size >= 1e-5 && size < 1e15;
  char buffer[kLongestNumber];
  const auto written = std::to_chars(buffer, buffer + sizeof buffer, value,
                                     plain ? std::chars_format::fixed : std::chars_format::scientific);
  out.append(buffer, written.ptr);
}

void append_rounded(std::string& out, double value, int decimals) {
  TIN_DCHECK(decimals >= 0 && decimals <= 9);
  // Below 2^53 the scaled value is rounded to an integer that a double holds.
  const double scaled = value * kPowers[decimals];
  if (!(std::fabs(scaled) < 9007199254740992.0)) return append_shortest(out, value);
  const std::int64_t rounded = std::llround(scaled);
  if (rounded < 0) out += '-';
  const std::uint64_t digits = static_cast<std::uint64_t>(rounded < 0 ? -rounded : rounded);
  append_integer(out, digits / kIntegerPowers[decimals]);
  std::uint64_t fraction = digits % kIntegerPowers[decimals];
  if (fraction == 0) return;
  char buffer[9];
  int length = decimals;
  for (int i = decimals - 1; i >= 0; --i, fraction /= 10) buffer[i] = static_cast<char>('0' + fraction % 10);
  while (buffer[length - 1] == '0') --length;
  out += '.';
  out.append(buffer, static_cast<std::size_t>(length));
}

}  // namespace proto
