// What commands that work on files have in common: how they speak, and how they are stopped.
#pragma once

#include <string>
#include <thread>

#include "tin/base/progress.h"
#include "tin/base/result.h"

namespace server::cli {

/// Says "tinsmith: FILE: what is wrong" on standard error. Returns the exit status, 1.
int fail(const std::string& file, const tin::base::Error& error);

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

/// While it lives, SIGINT and SIGTERM cancel the work in place of ending the program. One at a time.
class CancelOnSignal {
 public:
  explicit CancelOnSignal(tin::base::Progress& progress);
  ~CancelOnSignal();
  CancelOnSignal(const CancelOnSignal&) = delete;
  CancelOnSignal& operator=(const CancelOnSignal&) = delete;

  /// What came: 0 if nothing did. The exit status is then 128 and this.
  static int signal();
};

}  // namespace server::cli
