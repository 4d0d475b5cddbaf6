#include "server/api/routes.h"

namespace server::api {

http::Router make_router(Context& context) {
  http::Router router;
  add_landing(router);
  add_tins(router, context);
  add_edits(router, context);
  add_history(router, context);
  add_elevation(router, context);
  add_features(router, context);
  add_export(router, context);
  add_processes(router, context);
  add_jobs(router, context);
  return router;
}

}  // namespace server::api
