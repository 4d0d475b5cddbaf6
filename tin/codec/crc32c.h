// CRC-32C (Castagnoli): the checksum of everything that we store.
#pragma once

#include <cstdint>
#include <string_view>

namespace tin::codec {

/// Checksum of `bytes`; `before` is the checksum of what precedes them, so that parts can be summed in turn:
/// crc32c(b, crc32c(a)) == crc32c(a + b).
std::uint32_t crc32c(std::string_view bytes, std::uint32_t before = 0);

}  // namespace tin::codec
