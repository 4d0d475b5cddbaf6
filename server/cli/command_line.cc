#include "server/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <string>

#include "server/cli/serve.h"
#include "server/cli/token.h"
#include "server/gdal/decoder.h"
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
  serving->add_flag("--insecure", arguments.insecure,
                    "Serve without tokens where other machines can reach it: anybody may do anything");
  TokenArguments token;
  auto* making_token =
      app.add_subcommand("token", "Make a token for a client, and its entry for the configuration");
  making_token->add_option("--name", token.name, "Whose it is, for the log")->required();
  making_token->add_flag("--write", token.write, "It may write, too, not only read");
  // How the server runs itself again to read an uploaded file; not for people.
  const auto* decoding = app.add_subcommand("decode")->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (making_token->parsed()) return print_token(token);
  return decoding->parsed() ? gdal::run_decoder() : serve(arguments);
}

}  // namespace server::cli
