// What OGC API EDR adds to the document of the surface.
#pragma once

#include <string>

#include "proto/messages.h"

namespace server::api {

/// The queries that a surface at the path `self` answers, as members and as links.
void add_queries(proto::CollectionDocument& document, const std::string& self);

}  // namespace server::api
