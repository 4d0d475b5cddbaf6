// Checksums of rows: SQLite has none of its own, and a disk may lie.
#pragma once

#include <cstdint>
#include <string_view>

#include "server/store/store.h"

namespace server::store {

/// Over all fields of the row.
std::uint32_t checksum(const JournalRow& row);

/// Over all fields of the answer.
std::uint32_t checksum(const Answer& answer);

/// Over one chunk of a checkpoint and its place.
std::uint32_t checksum(std::uint64_t revision, std::int64_t chunk, std::string_view bytes);

}  // namespace server::store
