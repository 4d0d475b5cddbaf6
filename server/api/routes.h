// All resources of the server in one table.
#pragma once

#include "server/api/slots.h"
#include "server/app/catalogue.h"
#include "server/config.h"
#include "server/http/router.h"
#include "server/jobs/job_queue.h"

namespace server::api {

/// What resources work with. Outlives the router.
struct Context {
  Context(app::Catalogue& c, jobs::JobQueue& j, const Config& with)
      : catalogue(c),
        jobs(j),
        config(with),
        uploads(with.limits.uploads_at_once),
        exports(with.limits.exports_at_once),
        waiting(with.jobs.sync_waiting),
        edits(with.limits.edits_at_once),
        listeners(with.limits.listeners) {}

  app::Catalogue& catalogue;
  jobs::JobQueue& jobs;
  const Config& config;
  Slots uploads;  // files being read beside the jobs
  Slots exports;  // rasters being made
  Slots waiting;  // requests that wait for their job
  Slots edits;      // edits being applied or waiting for the disk
  Slots listeners;  // streams of changes
};

http::Router make_router(Context& context);

// One function per file of this folder.
void add_landing(http::Router& router);
void add_tins(http::Router& router, Context& context);
void add_edits(http::Router& router, Context& context);
void add_history(http::Router& router, Context& context);
void add_elevation(http::Router& router, Context& context);
void add_tin_service(http::Router& router, Context& context);
void add_collections(http::Router& router, Context& context);
void add_slope(http::Router& router, Context& context);
void add_profile(http::Router& router, Context& context);
void add_contours(http::Router& router, Context& context);
void add_volume(http::Router& router, Context& context);
void add_features(http::Router& router, Context& context);
void add_feature_edits(http::Router& router, Context& context);
void add_export(http::Router& router, Context& context);
void add_processes(http::Router& router, Context& context);
void add_jobs(http::Router& router, Context& context);

}  // namespace server::api
