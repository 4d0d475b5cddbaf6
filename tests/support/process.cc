#include "tests/support/process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/support/temp_dir.h"

namespace tests::support {
namespace {

pid_t start(const std::vector<std::string>& words, posix_spawn_file_actions_t& files) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t pid = -1;
  const int failed = ::posix_spawnp(&pid, arguments[0], &files, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw std::runtime_error(words.front() + " cannot be started");
  return pid;
}

int status_of(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string content(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

void to_file(posix_spawn_file_actions_t& files, int descriptor, const std::string& path) {
  ::posix_spawn_file_actions_addopen(&files, descriptor, path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
}

}  // namespace

Finished run(const std::vector<std::string>& words) {
  const TempDir folder;
  const std::string out = folder.path() / "out", err = folder.path() / "err";
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  to_file(files, 1, out);
  to_file(files, 2, err);
  Finished finished;
  finished.status = status_of(start(words, files));
  finished.out = content(out);
  finished.err = content(err);
  return finished;
}

Child::Child(const std::vector<std::string>& words, const std::filesystem::path& err_file) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, pipe[1], 1);
  to_file(files, 2, err_file.string());
  out_ = pipe[0];
  pid_ = start(words, files);
  ::close(pipe[1]);
}

Child::~Child() {
  if (pid_ > 0) {
    signal(SIGKILL);
    wait();
  }
  ::close(out_);
}

std::string Child::read_line() {
  std::string line;
  char c = 0;
  while (::read(out_, &c, 1) == 1 && c != '\n') line += c;
  return line;
}

void Child::signal(int number) {
  if (pid_ > 0) ::kill(pid_, number);
}

int Child::wait() {
  const int status = status_of(pid_);
  pid_ = -1;
  return status;
}

}  // namespace tests::support
