// Revisions as clients see them.
#pragma once

#include "proto/history.h"
#include "server/app/revisions.h"
#include "tin/frame/frame.h"

namespace server::api {

proto::RevisionDocument revision_document(const app::RevisionSummary& revision,
                                          const tin::frame::Frame& frame);

}  // namespace server::api
