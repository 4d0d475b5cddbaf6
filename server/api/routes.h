// All resources of the server in one table.
#pragma once

#include <atomic>
#include <functional>

#include "server/api/slots.h"
#include "server/app/catalogue.h"
#include "server/config.h"
#include "server/gdal/decoder.h"
#include "server/http/router.h"
#include "server/jobs/job_queue.h"
#include "server/tiles/tile_cache.h"

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
        tiles(static_cast<std::size_t>(with.limits.tile_cache_bytes), c.memory()),
        edits(with.limits.edits_at_once),
        listeners(with.limits.listeners) {}

  app::Catalogue& catalogue;
  jobs::JobQueue& jobs;
  const Config& config;
  gdal::Decoder decoder;  // reads uploads; in this process unless it is told which program to run
  std::atomic<bool> draining{false};         // the server is about to stop
  std::function<std::size_t()> connections;  // how many are open; may be empty
  Slots uploads;  // files being read beside the jobs
  Slots exports;  // rasters being made
  Slots waiting;  // requests that wait for their job
  tiles::TileCache tiles;
  Slots edits;      // edits being applied or waiting for the disk
  Slots listeners;  // streams of changes
};

http::Router make_router(Context& context);

// One function per file of this folder.
void add_landing(http::Router& router);
void add_operations(http::Router& router, Context& context);
void add_tins(http::Router& router, Context& context);
void add_edits(http::Router& router, Context& context);
void add_history(http::Router& router, Context& context);
void add_elevation(http::Router& router, Context& context);
void add_tin_service(http::Router& router, Context& context);
void add_collections(http::Router& router, Context& context);
void add_coverage(http::Router& router, Context& context);
void add_edr(http::Router& router, Context& context);
void add_slope(http::Router& router, Context& context);
void add_profile(http::Router& router, Context& context);
void add_contours(http::Router& router, Context& context);
void add_volume(http::Router& router, Context& context);
void add_features(http::Router& router, Context& context);
void add_feature_edits(http::Router& router, Context& context);
void add_tiles(http::Router& router, Context& context);
void add_export(http::Router& router, Context& context);
void add_processes(http::Router& router, Context& context);
void add_jobs(http::Router& router, Context& context);

}  // namespace server::api
