// LAS files made byte by byte, for tests of their reader and of imports.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tests::formats {

struct LasPoint {
  std::int32_t x, y, z;  // hundredths from (500000, 4100000, 0)
  std::uint8_t kind;     // its class
  bool withheld;
};

struct LasRecord {
  std::string user;
  std::uint16_t id;
  std::string content;
};

struct LasSpec {
  int minor = 2, format = 1;
  std::vector<LasPoint> points{};
  std::vector<LasRecord> records{}, extended{};  // the latter in LAS 1.4 only
  std::size_t gap = 0;                           // bytes that say nothing, between the parts
};

std::string las_file(const LasSpec& spec);

}  // namespace tests::formats
