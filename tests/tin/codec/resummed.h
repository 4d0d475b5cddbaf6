// Damaged bytes with a checksum that fits, so that the decoder behind the checksum is what gets tested.
#pragma once

#include <string>

#include "tin/codec/crc32c.h"

namespace tin::codec::testing {

/// `bytes` with its last four replaced by the checksum of the others.
inline std::string resummed(std::string bytes) {
  if (bytes.size() < 4) return bytes;
  bytes.resize(bytes.size() - 4);
  const std::uint32_t crc = crc32c(bytes);
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(crc >> (8 * i)));
  return bytes;
}

}  // namespace tin::codec::testing
