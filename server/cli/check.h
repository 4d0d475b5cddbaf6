// tinsmith check, backup and restore: a data folder without its server.
#pragma once

#include <string>

namespace server::cli {

/// Reads all that a data folder holds and says what is wrong with it; a server may run on it. Returns 0 when
/// it is sound, 1 when something is damaged, 2 when it cannot be read at all.
int check(const std::string& folder);

/// Writes a data folder to one file, while a server may run on it. Returns 0, or 1 when it could not be done.
int back_up(const std::string& folder, const std::string& file);

/// Makes a data folder of a backup. Returns 0, or 1 when it could not be done.
int restore(const std::string& file, const std::string& folder);

}  // namespace server::cli
