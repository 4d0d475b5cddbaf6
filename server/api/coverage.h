// The surface of a TIN as a collection beside those of its features.
#pragma once

#include "proto/messages.h"
#include "server/api/answer.h"

namespace server::api {

/// Whether a TIN has triangles and a place on the globe.
bool has_surface(const app::Summary& summary);

/// With relative links. Requires: has_surface().
proto::CollectionDocument surface_document(const app::Tin& tin, const app::Summary& summary);

}  // namespace server::api
