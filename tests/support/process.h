// Programs that a test runs: to their end, or beside it.
//
//   const Finished info = run({"gdalinfo", "-json", file});
//   Child child({"tinsmith", "serve"}, err_file);
//   const std::string line = child.read_line();
//   child.signal(SIGTERM); EXPECT_EQ(child.wait(), 0);
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace tests::support {

struct Finished {
  int status = -1;  // of exit; 128 and the signal's number if one ended it, as a shell says it
  std::string out;
  std::string err;
};

/// Found by PATH unless the first word has a slash. Throws if it cannot be started.
Finished run(const std::vector<std::string>& words);

/// A running program; killed if it still runs when the test is done with it.
class Child {
 public:
  /// What it says on standard error goes to `err_file`.
  Child(const std::vector<std::string>& words, const std::filesystem::path& err_file);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();

  /// The next line of its standard output; what there is of it when the output ends.
  std::string read_line();
  void signal(int number);
  /// Waits for its end; the status as in Finished.
  int wait();

 private:
  pid_t pid_ = -1;
  int out_ = -1;
};

}  // namespace tests::support
