#include "server/api/routes.h"

namespace server::api {

http::Router make_router(Context& context) {
  http::Router router;
  add_landing(router);
  add_operations(router, context);
  add_tins(router, context);
  add_edits(router, context);
  add_history(router, context);
  add_elevation(router, context);
  add_tin_service(router, context);
  add_collections(router, context);
  add_coverage(router, context);
  add_edr(router, context);
  add_slope(router, context);
  add_profile(router, context);
  add_contours(router, context);
  add_volume(router, context);
  add_features(router, context);
  add_feature_edits(router, context);
  add_tiles(router, context);
  add_export(router, context);
  add_processes(router, context);
  add_jobs(router, context);
  return router;
}

}  // namespace server::api
