// What commands that work on files have in common: how they speak, and how they are stopped.
#pragma once

#include <string>
#include <thread>

#include "tin/base/progress.h"
#include "tin/base/result.h"

namespace server::cli {

/// The exit status of a command line that makes no sense.
inline constexpr int kMisuse = 2;

/// Says "tinsmith: FILE: what is wrong" on standard error. Returns the exit status, 1.
int fail(const std::string& file, const tin::base::Error& error);
/// The same of what the command line says. Returns kMisuse.
int misuse(const std::string& file, const tin::base::Error& error);
/// The status of a command that printed what it found; 1 if not all of that could be written.
int unless_unprinted(int status);

/// Shows a bar on standard error while it lives, if that is a terminal and it is wanted.
class ProgressBar {
 public:
  ProgressBar(const tin::base::Progress& progress, bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

 private:
  std::jthread painter_;
};

/// While it lives, SIGINT, SIGTERM and SIGHUP cancel the work in place of ending the program; SIGHUP not where it was ignored
/// before, as nohup has it. One at a time.
class CancelOnSignal {
 public:
  explicit CancelOnSignal(tin::base::Progress& progress);
  ~CancelOnSignal();
  CancelOnSignal(const CancelOnSignal&) = delete;
  CancelOnSignal& operator=(const CancelOnSignal&) = delete;

  /// What came: 0 if nothing did. The exit status is then 128 and this.
  static int signal();

 private:
  void (*hang_up_)(int) = nullptr;  // who took SIGHUP before
};

}  // namespace server::cli
