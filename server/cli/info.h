// tinsmith info: what a file of elevations is.
#pragma once

#include <string>

#include "server/cli/content.h"

namespace server::cli {

struct InfoArguments {
  std::string file;
  ContentArguments content;
  bool json = false;
};

/// Reads all of the file. Returns the exit status: 0, or 1 when it is none that can be read.
int info(const InfoArguments& arguments);

}  // namespace server::cli
