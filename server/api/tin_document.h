// The document of a TIN, shared by the resources that answer with it.
#pragma once

#include "proto/messages.h"
#include "server/api/answer.h"

namespace server::api {

struct Context;

proto::TinDocument tin_document(const app::Tin& tin);

/// 201 with Location, ETag and the document; with what is to be said of the file, if it was made of one.
Response created_answer(const Context& context, const app::Tin& tin, const Request& request,
                        const proto::FileReport* file = nullptr);

}  // namespace server::api
