// What is left to a process that confined itself: each attempt is made by a child of this test.
#include "server/gdal/sandbox.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <iostream>
#include <thread>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

class SandboxTest : public ScratchTest {
 protected:
  /// Whether `attempt` succeeds in a child that confined itself to the scratch folder. Dies otherwise as it
  /// will.
  int status_of(const std::function<bool()>& attempt, const DecoderLimits& limits = {}) const {
    const pid_t child = ::fork();
    if (child == 0) {
      if (::chdir(path("").c_str()) != 0) ::_exit(8);
      if (!confine_this_process(limits, path(""))) ::_exit(9);
      ::_exit(attempt() ? 0 : 1);
    }
    int status = -1;
    ::waitpid(child, &status, 0);
    return status;
  }
  bool succeeds(const std::function<bool()>& attempt) const { return status_of(attempt) == 0; }
  bool is_denied(const std::function<bool()>& attempt) const {
    const int status = status_of(attempt);
    return WIFEXITED(status) && WEXITSTATUS(status) == 1;
  }
};

TEST_F(SandboxTest, ReadsItsFolderAndComputes) {
  file("upload", "content");
  EXPECT_TRUE(succeeds([] {
    const int in = ::open("upload", O_RDONLY);
    char bytes[7];
    return in >= 0 && ::read(in, bytes, 7) == 7;
  }));
  EXPECT_TRUE(succeeds([] { return ::mkdir("below", 0700) == 0 && ::link("upload", "below/link") == 0; }) ||
              !landlock_works());
}

TEST_F(SandboxTest, HasNoSockets) {
  for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK}) {
    EXPECT_TRUE(is_denied([family] { return ::socket(family, SOCK_STREAM, 0) >= 0 || errno != EPERM; }))
        << family;
  }
}

TEST_F(SandboxTest, StartsNoProgramsAndNoProcesses) {
  EXPECT_TRUE(is_denied([] { return ::fork() >= 0; }));
  EXPECT_TRUE(is_denied([] {
    ::execl("/bin/true", "true", nullptr);
    return false;
  }));
  EXPECT_TRUE(is_denied([] { return ::kill(::getppid(), 0) == 0; }));
}

TEST_F(SandboxTest, RaisesNoLimit) {
  EXPECT_TRUE(is_denied([] {
    const rlimit more{RLIM_INFINITY, RLIM_INFINITY};
    return ::setrlimit(RLIMIT_CPU, &more) == 0;
  }));
}

#if !defined(__SANITIZE_THREAD__)
TEST_F(SandboxTest, MayHaveThreads) {
  EXPECT_TRUE(succeeds([] {
    int done = 0;
    std::thread([&] { done = 1; }).join();
    return done == 1;
  }));
}
#endif

TEST_F(SandboxTest, SeesNoOtherFilesWhereTheKernelHasLandlock) {
  if (!landlock_works()) GTEST_SKIP() << "this kernel has no Landlock";
  const std::string secret =
      std::filesystem::temp_directory_path() / ("secret-" + std::to_string(::getpid()));
  ::close(::open(secret.c_str(), O_WRONLY | O_CREAT, 0600));
  EXPECT_TRUE(is_denied([&] { return ::open(secret.c_str(), O_RDONLY) >= 0; }));
  EXPECT_TRUE(is_denied([&] { return ::open((secret + "2").c_str(), O_WRONLY | O_CREAT, 0600) >= 0; }));
  EXPECT_TRUE(is_denied([] { return ::open("/etc/passwd", O_RDONLY) >= 0; }));
  EXPECT_TRUE(is_denied([] { return ::open("/proc/1/environ", O_RDONLY) >= 0; }));
  EXPECT_TRUE(is_denied([] { return ::open("/usr/bin/new", O_WRONLY | O_CREAT, 0600) >= 0; }));
  ::unlink(secret.c_str());
}

TEST_F(SandboxTest, FilesThatGrowTooLargeEndIt) {
  DecoderLimits limits;
  limits.file_bytes = 1000;
  const auto write = [](std::size_t size) {
    return [size] {
      const int out = ::open("out", O_WRONLY | O_CREAT | O_TRUNC, 0600);
      const std::string bytes(size, 'x');
      return ::write(out, bytes.data(), bytes.size()) == static_cast<ssize_t>(size) &&
             ::write(out, bytes.data(), bytes.size()) == static_cast<ssize_t>(size);
    };
  };
  EXPECT_EQ(status_of(write(500), limits), 0);
  const int status = status_of(write(501), limits);
  EXPECT_TRUE(WIFEXITED(status) ? WEXITSTATUS(status) == 1 : WTERMSIG(status) == SIGXFSZ);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(SandboxTest, MemoryIsBounded) {
  DecoderLimits limits;
  limits.memory_bytes = std::uint64_t{2} << 30;
  const auto reserve = [](std::size_t bytes) {
    return [bytes] {
      return ::mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED;
    };
  };
  EXPECT_EQ(status_of(reserve(std::size_t{1} << 28), limits), 0);
  EXPECT_NE(status_of(reserve(std::size_t{2} << 30), limits), 0);
}
#endif

TEST_F(SandboxTest, ComputingTimeIsBounded) {
  DecoderLimits limits;
  limits.cpu_seconds = 1;
  const int status = status_of(
      [] {
        unsigned sum = 1;
        while (sum != 0) sum = sum * 1664525 | 1;
        return true;
      },
      limits);
  EXPECT_TRUE(WIFSIGNALED(status));
}

}  // namespace
}  // namespace server::gdal::testing
