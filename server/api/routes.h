// All resources of the server in one table.
#pragma once

#include <semaphore>

#include "server/app/catalogue.h"
#include "server/config.h"
#include "server/http/router.h"
#include "server/jobs/job_queue.h"

namespace server::api {

/// What resources work with. Outlives the router.
struct Context {
  app::Catalogue& catalogue;
  jobs::JobQueue& jobs;
  const Config& config;
  std::counting_semaphore<> uploads{4};  // files being read at once, beside the jobs
};

http::Router make_router(Context& context);

// One function per file of this folder.
void add_landing(http::Router& router);
void add_tins(http::Router& router, Context& context);
void add_edits(http::Router& router, Context& context);
void add_elevation(http::Router& router, Context& context);
void add_features(http::Router& router, Context& context);
void add_export(http::Router& router, Context& context);
void add_processes(http::Router& router, Context& context);
void add_jobs(http::Router& router, Context& context);

}  // namespace server::api
