// Numbers as text: the same bytes for the same number, always.
#pragma once

#include <cstdint>
#include <string>

namespace proto {

void append_integer(std::string& out, std::uint64_t value);

/// The shortest decimal that reads back as `value`: plain from 1e-5 up to 1e15, scientific beyond.
/// Requires: finite. -0 is written as 0.
void append_shortest(std::string& out, double value);

/// `value` rounded (half away from zero) to `decimals` (0 to 9) without trailing zeros; values too large for
/// that to mean anything are written as by append_shortest(). Requires: finite.
void append_rounded(std::string& out, double value, int decimals);

}  // namespace proto
