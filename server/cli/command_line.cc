#include "server/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <string>

#include "server/cli/check.h"
#include "server/cli/serve.h"
#include "server/version.h"

namespace server::cli {

int run(int argc, char** argv) {
  CLI::App app("Tinsmith: a server for adaptive terrain TINs", "tinsmith");
  app.set_version_flag("--version", "tinsmith " + std::string(version()));
  app.require_subcommand(1);
  ServeArguments arguments;
  auto* serving = app.add_subcommand("serve", "Serve TINs over HTTP until SIGTERM or SIGINT");
  serving->add_option(
      "--listen", arguments.listen,
      "Address and port, 127.0.0.1:8080 unless the configuration says otherwise; port 0 takes a free one");
  serving->add_option("--data", arguments.data, "Folder of the TINs; made if it is not there");
  serving->add_option("--config", arguments.config,
                      "Configuration file (JSON); see deploy/config.example.json");
  std::string folder, file;
  auto* checking =
      app.add_subcommand("check", "Verify a data folder: checksums, digests, Delaunay (0 sound, 1 damaged)");
  checking->add_option("folder", folder, "The data folder; a server may run on it")->required();
  auto* backing_up = app.add_subcommand("backup", "Write a data folder to one file; a server may run on it");
  backing_up->add_option("folder", folder, "The data folder")->required();
  backing_up->add_option("file", file, "The backup, which must not be there yet")->required();
  auto* restoring = app.add_subcommand("restore", "Make a data folder of a backup");
  restoring->add_option("file", file, "The backup")->required();
  restoring->add_option("folder", folder, "A folder that is empty or not there yet")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (*checking) return check(folder);
  if (*backing_up) return back_up(folder, file);
  if (*restoring) return restore(file, folder);
  return serve(arguments);
}

}  // namespace server::cli
