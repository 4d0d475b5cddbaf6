#include "server/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <string>

#include "proto/processes/simplify.h"
#include "server/cli/check.h"
#include "server/cli/info.h"
#include "server/cli/output_file.h"
#include "server/cli/serve.h"
#include "server/cli/simplify.h"
#include "server/cli/terminal.h"
#include "server/cli/token.h"
#include "server/gdal/decoder.h"
#include "server/version.h"

namespace server::cli {

namespace {

/// Of a number without a sign: the parser would take -1, and what is too large, for the largest of all.
CLI::Validator not_negative() {
  constexpr std::size_t kMostDigits = 18;
  return CLI::Validator(
      [](std::string& text) -> std::string {
        if (text.starts_with('-')) return "must not be negative";
        return text.size() > kMostDigits ? "is too large" : "";
      },
      "");
}

CLI::App* add_serve(CLI::App& app, ServeArguments& arguments) {
  auto* command = app.add_subcommand("serve", "Serve TINs over HTTP until SIGTERM or SIGINT");
  command->add_option(
      "--listen", arguments.listen,
      "Address and port, 127.0.0.1:8080 unless the configuration says otherwise; port 0 takes a free one");
  command->add_option("--data", arguments.data, "Folder of the TINs; made if it is not there");
  command->add_option("--config", arguments.config,
                      "Configuration file (JSON); see deploy/config.example.json");
  command->add_flag("--insecure", arguments.insecure,
                    "Serve without tokens where other machines can reach it: anybody may do anything");
  return command;
}

CLI::App* add_token(CLI::App& app, TokenArguments& arguments) {
  auto* command =
      app.add_subcommand("token", "Make a token for a client, and its entry for the configuration");
  command->add_option("--name", arguments.name, "Whose it is, for the log")->required();
  command->add_flag("--write", arguments.write, "It may write, too, not only read");
  return command;
}

/// What a person may say of the content of a file, as clients of the server do.
void add_content_options(CLI::App& command, ContentArguments& content) {
  command.add_option("--crs", content.crs, "CRS of the file, in place of what it says: EPSG:n or WKT");
  command.add_option("--format", content.format, "Format of the file, where its content leaves it open");
  command.add_option("--layer", content.layer, "Layer of a vector file, surface of a LandXML; the first unless given");
  command.add_option("--z-field", content.z_field, "Column or field of the heights, where its name does not say it");
  command.add_option("--class", content.classes, "Classes of the LAS points to take, such as 2,9; all unless given")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(0, 255));
}

CLI::App* add_simplify(CLI::App& app, SimplifyArguments& arguments) {
  auto* command = app.add_subcommand(
      "simplify", "Make a TIN of few vertices that stays within a tolerance of every sample of a file");
  command->add_option("input", arguments.input, "Raster of elevations, or points")->required();
  command
      ->add_option("-o,--output", arguments.output,
                   "File to write; its suffix says the format: " + output_formats())
      ->required();
  command->add_option("-t,--tolerance", arguments.tolerance,
                      "Largest vertical distance to any sample, in the unit of the elevations");
  command
      ->add_option("--max-vertices", arguments.max_vertices,
                   "No more vertices than these; goes before the tolerance (the exit status is 3 then)")
      ->check(not_negative());
  command->add_option("--max-seconds", arguments.max_seconds,
                      "Certify and write the best result so far once so much time is spent");
  command->add_option("--effort", arguments.effort, "fast, balanced, thorough or best")
      ->capture_default_str();
  command
      ->add_option("--elevations", arguments.elevations,
                   "source: vertices have those of the samples; fit: any within the tolerance, for fewer vertices")
      ->capture_default_str();
  command
      ->add_option("--against", arguments.against,
                   "samples: each of them is within the tolerance; surface: so is all of the surface that they make")
      ->capture_default_str();
  const std::string plateau = std::to_string(proto::kPlateauSamples);
  command
      ->add_flag("--keep-flat{" + plateau + "}", arguments.keep_flat,
                 "Do not tilt water and other plateaus of at least so many level samples: --keep-flat=N, or " +
                     plateau + " for --keep-flat alone; off unless given")
      ->check(not_negative());
  command->add_option("--seed", arguments.seed, "Chooses the way of the search")
      ->check(not_negative())
      ->capture_default_str();
  command
      ->add_option("--threads", arguments.threads,
                   "How many threads work, no more than the processor has; 0: as many as that")
      ->check(not_negative())
      ->capture_default_str();
  command
      ->add_option("--memory", arguments.memory,
                   "Megabytes of a raster's samples to hold at a time; what is more waits in temporary files")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  command->add_option("--scratch", arguments.scratch,
                      "Folder of temporary files, on a disk; the output's unless given");
  add_content_options(*command, arguments.content);
  command->add_option("--duplicates", arguments.duplicates, "Of points at one position: replace (the last stays), keep, mean, max, min or reject")
      ->capture_default_str();
  command->add_flag("--json", arguments.json, "Print the report as JSON");
  command->add_flag("-q,--quiet", arguments.quiet, "Print no progress bar, and no report but that of --json");
  return command;
}

CLI::App* add_info(CLI::App& app, InfoArguments& arguments) {
  auto* command =
      app.add_subcommand("info", "Say what a file of elevations is: format, CRS, size, range of heights");
  command->add_option("file", arguments.file, "Raster of elevations, or points")->required();
  add_content_options(*command, arguments.content);
  command->add_flag("--json", arguments.json, "Print JSON");
  return command;
}

/// A data folder, and a file beside it.
struct FolderArguments {
  std::string folder, file;
};

CLI::App* add_check(CLI::App& app, FolderArguments& arguments) {
  auto* command =
      app.add_subcommand("check", "Verify a data folder: checksums, digests, Delaunay (0 sound, 1 damaged)");
  command->add_option("folder", arguments.folder, "The data folder; a server may run on it")->required();
  return command;
}

CLI::App* add_backup(CLI::App& app, FolderArguments& arguments) {
  auto* command = app.add_subcommand("backup", "Write a data folder to one file; a server may run on it");
  command->add_option("folder", arguments.folder, "The data folder")->required();
  command->add_option("file", arguments.file, "The backup, which must not be there yet")->required();
  return command;
}

CLI::App* add_restore(CLI::App& app, FolderArguments& arguments) {
  auto* command = app.add_subcommand("restore", "Make a data folder of a backup");
  command->add_option("file", arguments.file, "The backup")->required();
  command->add_option("folder", arguments.folder, "A folder that is empty or not there yet")->required();
  return command;
}

}  // namespace

int run(int argc, char** argv) {
  CLI::App app("Tinsmith: adaptive terrain TINs, served over HTTP or made of files", "tinsmith");
  app.set_version_flag("--version", "tinsmith " + std::string(version()));
  app.require_subcommand(1);
  app.failure_message([](const CLI::App* all, const CLI::Error& error) {
    return "tinsmith: " + CLI::FailureMessage::simple(all, error);
  });
  ServeArguments serving;
  SimplifyArguments simplifying;
  InfoArguments informing;
  TokenArguments token;
  FolderArguments keeping;
  add_serve(app, serving);
  const auto* simplify_command = add_simplify(app, simplifying);
  const auto* info_command = add_info(app, informing);
  const auto* token_command = add_token(app, token);
  const auto* check_command = add_check(app, keeping);
  const auto* backup_command = add_backup(app, keeping);
  const auto* restore_command = add_restore(app, keeping);
  // How the server runs itself again to read an uploaded file; not for people.
  const auto* decode_command = app.add_subcommand("decode")->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kMisuse;
  }
  if (simplify_command->parsed()) return unless_unprinted(simplify(simplifying));
  if (info_command->parsed()) return unless_unprinted(info(informing));
  if (token_command->parsed()) return unless_unprinted(print_token(token));
  if (decode_command->parsed()) return gdal::run_decoder();
  if (check_command->parsed()) return unless_unprinted(check(keeping.folder));
  if (backup_command->parsed()) return back_up(keeping.folder, keeping.file);
  if (restore_command->parsed()) return restore(keeping.file, keeping.folder);
  return serve(serving);
}

}  // namespace server::cli
