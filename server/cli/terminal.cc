#include "server/cli/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <system_error>

namespace server::cli {

namespace {

constexpr int kBarWidth = 40;
constexpr std::chrono::milliseconds kRepaint{100};

std::atomic<tin::base::Progress*> watched{nullptr};
std::atomic<int> caught{0};
static_assert(std::atomic<tin::base::Progress*>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may touch nothing else");

extern "C" void note_signal(int number) {
  caught.store(number);
  if (tin::base::Progress* const progress = watched.load()) progress->cancel();
}

void paint(double fraction) {
  const int done = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarWidth);
  std::string bar(static_cast<std::size_t>(done), '=');
  bar.resize(kBarWidth, ' ');
  std::fprintf(stderr, "\r[%s] %3d %%", bar.c_str(), static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0)));
}

}  // namespace

int fail(const std::string& file, const tin::base::Error& error) {
  const std::string at = file.empty() ? "" : file + ": ";
  std::fprintf(stderr, "tinsmith: %s%s\n", at.c_str(), error.message.c_str());
  return 1;
}

int unless_unprinted(int status) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  const std::string why = std::generic_category().message(errno);
  return fail("standard output", tin::base::error(tin::base::Code::kStorage, "cannot be written: " + why));
}

int misuse(const std::string& file, const tin::base::Error& error) {
  fail(file, error);
  return kMisuse;
}

ProgressBar::ProgressBar(const tin::base::Progress& progress, bool wanted) {
  if (!wanted || isatty(STDERR_FILENO) == 0) return;
  painter_ = std::jthread([&progress](const std::stop_token& stop) {
    std::mutex unused;
    std::condition_variable_any stopping;
    while (!stop.stop_requested()) {
      paint(progress.fraction());
      std::unique_lock lock(unused);
      stopping.wait_for(lock, stop, kRepaint, [] { return false; });
    }
    std::fprintf(stderr, "\r%*s\r", kBarWidth + 8, "");  // gone when the result is there
  });
}

ProgressBar::~ProgressBar() = default;

CancelOnSignal::CancelOnSignal(tin::base::Progress& progress) {
  watched.store(&progress);
  std::signal(SIGINT, note_signal);
  std::signal(SIGTERM, note_signal);
  hang_up_ = std::signal(SIGHUP, note_signal);
  if (hang_up_ == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

CancelOnSignal::~CancelOnSignal() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGHUP, hang_up_);
  watched.store(nullptr);
}

int CancelOnSignal::signal() {
  return caught.load();
}

}  // namespace server::cli
