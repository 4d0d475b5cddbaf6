// The commands of the program.
#pragma once

namespace server::cli {

/// Runs what the arguments ask for and returns the exit status: 0 done, 1 failed, 2 wrong usage.
int run(int argc, char** argv);

}  // namespace server::cli
