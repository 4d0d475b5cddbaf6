// tinsmith token
#pragma once

#include <string>

namespace server::cli {

struct TokenArguments {
  std::string name;
  bool write = false;
};

/// Prints a new token, and the entry for the configuration that grants it. Returns the exit status.
int print_token(const TokenArguments& arguments);

}  // namespace server::cli
