#include "server/gdal/sandbox.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <memory>

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // shadow memory takes terabytes of address space
#else
constexpr bool kSanitized = false;
#endif

tin::base::Error refused(const char* what) {
  return error(Code::kInternal,
               std::string("the decoder cannot confine itself: ") + what + ": " + std::strerror(errno));
}

bool limit(int resource, std::uint64_t most) {
  const rlimit both{most, most};
  return setrlimit(static_cast<__rlimit_resource_t>(resource), &both) == 0;
}

Result<void> set_limits(const DecoderLimits& limits) {
  constexpr std::uint64_t kDescriptors = 64;
  const auto cpu_seconds = static_cast<std::uint64_t>(limits.cpu_seconds);
  const bool set = (kSanitized || limit(RLIMIT_AS, limits.memory_bytes)) && limit(RLIMIT_CPU, cpu_seconds) &&
                   limit(RLIMIT_FSIZE, limits.file_bytes) && limit(RLIMIT_NOFILE, kDescriptors) &&
                   limit(RLIMIT_CORE, 0) && std::signal(SIGXFSZ, SIG_DFL) != SIG_ERR;  // the server ignores it
  if (!set) return refused("limits");
  return {};
}

// --- System calls -----------------------------------------------------------------------------------------

constexpr std::array kAllowed = {
    SCMP_SYS(read), SCMP_SYS(readv), SCMP_SYS(pread64), SCMP_SYS(preadv), SCMP_SYS(write), SCMP_SYS(writev),
    SCMP_SYS(pwrite64), SCMP_SYS(lseek), SCMP_SYS(close), SCMP_SYS(open), SCMP_SYS(openat), SCMP_SYS(stat),
    SCMP_SYS(lstat), SCMP_SYS(fstat), SCMP_SYS(newfstatat), SCMP_SYS(statx), SCMP_SYS(statfs),
    SCMP_SYS(fstatfs), SCMP_SYS(access), SCMP_SYS(faccessat), SCMP_SYS(faccessat2), SCMP_SYS(readlink),
    SCMP_SYS(readlinkat), SCMP_SYS(getdents64), SCMP_SYS(getcwd), SCMP_SYS(fcntl), SCMP_SYS(flock),
    SCMP_SYS(fadvise64), SCMP_SYS(mkdir), SCMP_SYS(mkdirat), SCMP_SYS(rmdir), SCMP_SYS(unlink),
    SCMP_SYS(unlinkat), SCMP_SYS(link), SCMP_SYS(linkat), SCMP_SYS(ftruncate), SCMP_SYS(fsync),
    SCMP_SYS(fdatasync), SCMP_SYS(fchmod), SCMP_SYS(fallocate), SCMP_SYS(copy_file_range), SCMP_SYS(sendfile),
    SCMP_SYS(umask),
    // memory
    SCMP_SYS(mmap), SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(mprotect), SCMP_SYS(madvise), SCMP_SYS(brk),
    // threads and time
    SCMP_SYS(futex), SCMP_SYS(set_robust_list), SCMP_SYS(rseq), SCMP_SYS(sched_yield),
    SCMP_SYS(sched_getaffinity), SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres), SCMP_SYS(gettimeofday),
    SCMP_SYS(time), SCMP_SYS(nanosleep), SCMP_SYS(clock_nanosleep), SCMP_SYS(restart_syscall),
    SCMP_SYS(gettid), SCMP_SYS(exit), SCMP_SYS(exit_group), SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(rt_sigreturn), SCMP_SYS(sigaltstack), SCMP_SYS(tgkill),
    // who and where we are
    SCMP_SYS(getrandom), SCMP_SYS(sysinfo), SCMP_SYS(uname), SCMP_SYS(getpid), SCMP_SYS(getuid),
    SCMP_SYS(geteuid), SCMP_SYS(getgid), SCMP_SYS(getegid), SCMP_SYS(getrlimit), SCMP_SYS(poll),
    SCMP_SYS(ppoll)};

/// What is not allowed fails with EPERM, as it does for one without rights; libraries get along with that.
Result<void> filter_system_calls() {
  const std::unique_ptr<void, decltype(&seccomp_release)> filter(seccomp_init(SCMP_ACT_ERRNO(EPERM)),
                                                                 seccomp_release);
  if (!filter) return refused("seccomp");
  int failed = 0;
  for (const int call : kAllowed) failed |= seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, call, 0);
  if (kSanitized) {
    // How the sanitizers' runtime asks whether memory can be read.
    for (const int call : {SCMP_SYS(pipe), SCMP_SYS(pipe2)})
      failed |= seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, call, 0);
  }
  // Threads, but no processes. clone3 hides its flags from filters; without it glibc takes clone.
  failed |= seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
                             SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD));
  failed |= seccomp_rule_add(filter.get(), SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
  // Limits may be read, not set.
  failed |= seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(prlimit64), 1, SCMP_A2(SCMP_CMP_EQ, 0));
  failed |=
      seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(prctl), 1, SCMP_A0(SCMP_CMP_EQ, PR_SET_NAME));
  if (failed != 0 || seccomp_load(filter.get()) != 0) return refused("seccomp");
  return {};
}

// --- Files ------------------------------------------------------------------------------------------------

constexpr std::uint64_t kReading =
    LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR | LANDLOCK_ACCESS_FS_EXECUTE;
constexpr std::uint64_t kWriting = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                   LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_DIR |
                                   LANDLOCK_ACCESS_FS_MAKE_REG;
constexpr std::uint64_t kNever = LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_SOCK |
                                 LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
                                 LANDLOCK_ACCESS_FS_MAKE_SYM;

long landlock_version() {
  return syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
}

/// Whether `path` (a folder, or a file) is open to the ruleset; one that is not there needs no rule.
bool allow_path(int ruleset, const std::string& path, std::uint64_t rights) {
  const int place = ::open(path.c_str(), O_PATH | O_CLOEXEC | O_DIRECTORY);
  if (place < 0) return errno == ENOENT || errno == ENOTDIR;
  landlock_path_beneath_attr rule{};
  rule.allowed_access = rights;
  rule.parent_fd = place;
  const bool added = syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
  ::close(place);
  return added;
}

Result<void> confine_files(const std::string& folder) {
  const long version = landlock_version();
  if (version < 1) return {};
  const std::uint64_t links =
      version >= 2 ? LANDLOCK_ACCESS_FS_REFER : 0;  // from the folder into its folders
  landlock_ruleset_attr rules{};
  rules.handled_access_fs = kReading | kWriting | kNever | links;
  const int ruleset = static_cast<int>(syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0));
  if (ruleset < 0) return refused("landlock");
  bool allowed = allow_path(ruleset, folder, kReading | kWriting | links);
  for (const char* readable : {"/usr", "/lib", "/lib64"})
    allowed = allowed && allow_path(ruleset, readable, kReading);
  for (const char* variable : {"PROJ_DATA", "PROJ_LIB", "GDAL_DATA"}) {
    if (const char* place = std::getenv(variable)) allowed = allowed && allow_path(ruleset, place, kReading);
  }
  const bool confined = allowed && syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
  ::close(ruleset);
  if (!confined) return refused("landlock");
  return {};
}

}  // namespace

bool landlock_works() {
  return landlock_version() >= 1;
}

Result<void> confine_this_process(const DecoderLimits& limits, const std::string& folder) {
  if (auto set = set_limits(limits); !set) return set;
  prctl(PR_SET_DUMPABLE, 0);
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return refused("privileges");
  if (auto confined = confine_files(folder); !confined) return confined;
  return filter_system_calls();
}

}  // namespace server::gdal
