// tinsmith serve
#pragma once

#include <optional>
#include <string>

namespace server::cli {

/// What stands on the command line; it goes before the configuration file.
struct ServeArguments {
  std::optional<std::string> listen;
  std::optional<std::string> data;
  std::optional<std::string> config;
  bool insecure = false;
};

/// Serves until SIGTERM or SIGINT, then drains. Returns the exit status.
int serve(const ServeArguments& arguments);

}  // namespace server::cli
