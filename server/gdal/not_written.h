// The error of a file that could not be written.
#pragma once

#include <filesystem>
#include <string>

#include "tin/base/result.h"

namespace server::gdal {

/// kNoSpace when there is hardly any room left beside `file`, else kStorage: GDAL does not say what the system said.
tin::base::Error not_written(std::string message, const std::filesystem::path& file);

}  // namespace server::gdal
