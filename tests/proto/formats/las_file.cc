#include "tests/proto/formats/las_file.h"

#include <array>
#include <cstring>

namespace tests::formats {
namespace {

template <class T>
void put(std::string& to, std::size_t at, T value) {
  std::memcpy(to.data() + at, &value, sizeof value);  // on little-endian machines
}

std::string record(const LasRecord& record, bool extended) {
  std::string bytes(extended ? 60 : 54, '\0');
  std::memcpy(bytes.data() + 2, record.user.data(), record.user.size());
  put(bytes, 18, record.id);
  if (extended) {
    put(bytes, 20, static_cast<std::uint64_t>(record.content.size()));
  } else {
    put(bytes, 20, static_cast<std::uint16_t>(record.content.size()));
  }
  return bytes + record.content;
}

std::string point(const LasPoint& point, int format, std::size_t bytes) {
  std::string out(bytes, '\0');
  put(out, 0, point.x);
  put(out, 4, point.y);
  put(out, 8, point.z);
  if (format < 6) {
    out[15] = static_cast<char>(point.kind | (point.withheld ? 0x80 : 0));
  } else {
    out[15] = point.withheld ? 4 : 0;
    out[16] = static_cast<char>(point.kind);
  }
  return out;
}

}  // namespace

std::string las_file(const LasSpec& spec) {
  constexpr std::array<std::size_t, 11> kBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  const std::size_t header = spec.minor < 3 ? 227 : spec.minor == 3 ? 235 : 375;
  const std::size_t bytes = kBytes[static_cast<std::size_t>(spec.format)] + spec.gap;
  std::string out(header + spec.gap, '\0'), records;
  for (const LasRecord& one : spec.records) records += record(one, false);
  records += std::string(spec.gap, '\x55');
  std::memcpy(out.data(), "LASF", 4);
  out[24] = 1;
  out[25] = static_cast<char>(spec.minor);
  put(out, 94, static_cast<std::uint16_t>(header + spec.gap));
  put(out, 96, static_cast<std::uint32_t>(header + spec.gap + records.size()));
  put(out, 100, static_cast<std::uint32_t>(spec.records.size()));
  out[104] = static_cast<char>(spec.format);
  put(out, 105, static_cast<std::uint16_t>(bytes));
  put(out, 107, static_cast<std::uint32_t>(spec.points.size()));
  for (std::size_t axis = 0; axis < 3; ++axis) put(out, 131 + 8 * axis, 0.01);
  put(out, 155, 500000.0);
  put(out, 163, 4100000.0);
  std::string points;
  for (const LasPoint& one : spec.points) points += point(one, spec.format, bytes);
  if (spec.minor == 4) {
    put(out, 235, static_cast<std::uint64_t>(out.size() + records.size() + points.size()));
    put(out, 243, static_cast<std::uint32_t>(spec.extended.size()));
    put(out, 247, static_cast<std::uint64_t>(spec.points.size()));
  }
  out += records + points;
  for (const LasRecord& one : spec.extended) out += record(one, true);
  return out;
}

}  // namespace tests::formats
