// The tables, and what leads from those of older versions to those of this one.
#pragma once

#include <cstdint>

#include "server/store/sqlite_internal.h"
#include "tin/base/result.h"

namespace server::store {

/// The version that this program writes.
std::int64_t schema_version();

/// Makes the tables of a new database, or brings an older one up to date; switches to the write-ahead log.
/// Errors: kUnsupported when a newer version wrote it, or it is no database of ours; kStorage.
tin::base::Result<void> prepare_schema(Database& database);

/// Whether the database is of this version, without changing it. Errors: kUnsupported; kStorage.
tin::base::Result<void> check_schema(Database& database);

}  // namespace server::store
