// Jobs in the store: they are known again after a restart.
#pragma once

#include <vector>

#include "server/jobs/job_queue.h"
#include "server/store/store.h"

namespace server::app {

/// Thread-safe. What cannot be written is logged.
class StoredJobs : public jobs::JobMemory {
 public:
  explicit StoredJobs(store::Store& store) : store_(store) {}

  /// All that is remembered, in the order of submission. Errors: kStorage.
  tin::base::Result<std::vector<jobs::JobStatus>> recall();

  tin::base::Result<void> remember(const jobs::JobStatus& job) override;
  void forget(const jobs::JobId& id) override;

 private:
  store::Store& store_;
};

}  // namespace server::app
