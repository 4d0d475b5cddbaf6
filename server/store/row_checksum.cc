#include "server/store/row_checksum.h"

#include <array>

#include "tin/codec/crc32c.h"

namespace server::store {
namespace {

std::uint32_t add_number(std::uint64_t number, std::uint32_t crc) {
  std::array<char, 8> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(number >> (8 * i));
  return tin::codec::crc32c({bytes.data(), bytes.size()}, crc);
}

// With its length, so that no byte can change sides between two texts.
std::uint32_t add_text(std::string_view text, std::uint32_t crc) {
  return tin::codec::crc32c(text, add_number(text.size(), crc));
}

}  // namespace

std::uint32_t checksum(const JournalRow& row) {
  std::uint32_t crc = add_number(row.revision, 0);
  crc = add_text(row.record, crc);
  crc = add_number(static_cast<std::uint64_t>(row.info.time_ms), crc);
  crc = add_text(row.info.author, crc);
  return add_text(row.info.note, crc);
}

std::uint32_t checksum(const Answer& answer) {
  std::uint32_t crc = add_text(answer.key, 0);
  crc = add_text(answer.request, crc);
  crc = add_text(answer.bytes, crc);
  return add_number(static_cast<std::uint64_t>(answer.time_ms), crc);
}

std::uint32_t checksum(std::uint64_t revision, std::int64_t chunk, std::string_view bytes) {
  return add_text(bytes, add_number(static_cast<std::uint64_t>(chunk), add_number(revision, 0)));
}

}  // namespace server::store
