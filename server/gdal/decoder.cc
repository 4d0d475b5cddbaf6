// The server's side of a decoder.
#include "server/gdal/decoder.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

#include "server/gdal/decoder_order.h"
#include "server/gdal/import_internal.h"
#include "server/gdal/import_wire.h"
#include "server/gdal/workspace.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using Clock = std::chrono::steady_clock;

constexpr int kAskEvery_ms = 50;  // whether the import was cancelled
constexpr std::size_t kReadBytes = 256 * 1024;
constexpr int kPipeBytes = 1 << 20;

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }

 private:
  int number_;
};

tin::base::Error not_started(const char* what) {
  return error(Code::kInternal,
               std::string("no decoder could be started: ") + what + ": " + std::strerror(errno));
}

/// The order as a file that exists in memory only.
Result<Descriptor> order_file(const std::string& order) {
  Descriptor file(::memfd_create("order", MFD_CLOEXEC));
  if (file.number() < 0) return not_started("memfd");
  const auto written = ::pwrite(file.number(), order.data(), order.size(), 0);
  if (written != static_cast<ssize_t>(order.size())) return not_started("the order");
  return file;
}

/// Of the environment only what a decoder needs to find its data, and what sanitizers are told.
std::vector<std::string> environment() {
  std::vector<std::string> kept;
  for (const char* name : {"PROJ_DATA", "PROJ_LIB", "GDAL_DATA", "LD_LIBRARY_PATH", "ASAN_OPTIONS",
                           "UBSAN_OPTIONS", "TSAN_OPTIONS"}) {
    if (const char* value = std::getenv(name)) kept.push_back(std::string(name) + "=" + value);
  }
  return kept;
}

/// A decoder at work; killed and waited for at the end of the scope.
class Child {
 public:
  ~Child() { end(); }
  Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  Child& operator=(Child&&) = delete;

  /// Starts `program decode` in `folder` with these as standard input and output, and nothing else open.
  static Result<Child> start(const std::string& program, const std::string& folder, int in, int out) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    std::string name = "tinsmith", command = "decode";
    std::array<char*, 3> words{name.data(), command.data(), nullptr};
    std::vector<std::string> variables = environment();
    std::vector<char*> pointers;
    for (std::string& variable : variables) pointers.push_back(variable.data());
    pointers.push_back(nullptr);
    pid_t pid = -1;
    errno = ::posix_spawn(&pid, program.c_str(), &actions, &attributes, words.data(), pointers.data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (errno != 0) return not_started(program.c_str());
    return Child(pid);
  }

  void kill() {
    if (pid_ > 0) ::kill(pid_, SIGKILL);
  }

  /// Waits for its end; the status is as waitpid() gives it.
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  explicit Child(pid_t pid) : pid_(pid) {}
  void end() {
    if (pid_ <= 0) return;
    kill();
    wait();
  }
  pid_t pid_ = -1;
};

/// Why there is no whole answer, from the way in which the decoder ended.
tin::base::Error broken(int status, const DecoderLimits& limits) {
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGXCPU) {
      return error(Code::kTooLarge, "Reading the file takes more than " + std::to_string(limits.cpu_seconds) +
                                        " seconds of computing, the limit here");
    }
    if (WTERMSIG(status) == SIGXFSZ) {
      return error(Code::kTooLarge, "Reading the file takes more temporary space than the limit here");
    }
    if (WTERMSIG(status) == SIGKILL) {
      return error(Code::kTooLarge, "Reading the file was ended by the system, probably for want of memory");
    }
    return error(Code::kInvalidValue, "The file is damaged in a way that broke its decoder (signal " +
                                          std::to_string(WTERMSIG(status)) + ")");
  }
  if (WEXITSTATUS(status) == kNotConfined)
    return error(Code::kInternal, "the decoder could not confine itself");
  return error(Code::kInvalidValue, "The file is damaged in a way that broke its decoder");
}

/// Reads what the decoder sends until it is whole, over, late or not wanted any more.
class Conversation {
 public:
  Conversation(Child& child, int from, const DecoderLimits& limits, tin::base::Progress* progress)
      : child_(child), from_(from), limits_(limits), progress_(progress) {}

  Result<Import> hold(ImportReceiver& receiver) {
    const auto end = Clock::now() + std::chrono::seconds(limits_.seconds);
    std::vector<char> block(kReadBytes);
    while (true) {
      if (progress_ != nullptr && progress_->cancelled()) return cancelled_error();
      if (Clock::now() >= end) {
        return error(Code::kTooLarge, "Reading the file takes longer than " +
                                          std::to_string(limits_.seconds) + " seconds, the limit here");
      }
      pollfd waiting{from_, POLLIN, 0};
      if (::poll(&waiting, 1, kAskEvery_ms) <= 0) continue;
      const ssize_t got = ::read(from_, block.data(), block.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      if (auto fine = receiver.take({block.data(), static_cast<std::size_t>(got)}); !fine)
        return fine.error();
    }
    const int status = child_.wait();
    if (!receiver.whole()) return broken(status, limits_);
    return std::move(receiver).outcome();
  }

 private:
  Child& child_;
  const int from_;
  const DecoderLimits& limits_;
  tin::base::Progress* const progress_;
};

}  // namespace

Result<Import> Decoder::import_file(const std::filesystem::path& uploaded, const ImportOptions& options,
                                    tin::base::Progress* progress) const {
  if (program.empty()) return server::gdal::import_file(uploaded, options, progress);
  const auto workspace = Workspace::create(uploaded, kUploadName);
  if (!workspace) return workspace.error();
  const auto order = order_file(encode_order({limits, options}));
  if (!order) return order.error();
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return not_started("pipe");
  const Descriptor from(ends[0]);
  Descriptor to(ends[1]);
  ::fcntl(from.number(), F_SETPIPE_SZ, kPipeBytes);
  auto child = Child::start(program, workspace->folder(), order->number(), to.number());
  if (!child) return child.error();
  to = Descriptor();  // so that the pipe ends with the decoder
  ImportReceiver receiver(options, progress);
  return Conversation(*child, from.number(), limits, progress).hold(receiver);
}

}  // namespace server::gdal
