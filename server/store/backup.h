// A whole store as one file, taken while a server writes it, and back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/store/files.h"
#include "tin/base/result.h"

namespace server::store {

/// Writes what the store of `folder` holds at one moment to `file`, which must not be there: the database,
/// and in it the files beside it. The file is durable when this returns. Errors: kNotFound (no store),
/// kConflict (the file is there), kUnsupported (another version's), kStorage (damage, too), kNoSpace; then
/// there is no such file.
tin::base::Result<void> back_up(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Makes a store of a backup, in a folder that is empty or not there yet. Errors: kNotFound (no such file),
/// kConflict (the folder has something in it), kUnsupported (no backup of ours), kStorage (damage, too),
/// kNoSpace.
tin::base::Result<void> restore(const std::filesystem::path& file, const std::filesystem::path& folder);

/// What is wrong with the store of a folder beside its TINs, a sentence each: the database's own structure,
/// files that rows name, answers that were kept. Errors: as open_sqlite_store_for_reading().
tin::base::Result<std::vector<std::string>> find_damage(const std::filesystem::path& folder);

}  // namespace server::store
