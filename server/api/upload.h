// POST /tins with a data file.
#pragma once

#include "server/api/answer.h"
#include "server/api/routes.h"

namespace server::api {

/// Imports the uploaded file, at once or, with `Prefer: respond-async`, as a job. Errors: as app::import_tin,
/// and for bad parameters; kTooMany when too many files are being read.
Result<Response> create_from_upload(Context& context, Request& request);

/// The file name that a Content-Disposition field gives; "" if none. Never a path: what stands before a slash
/// is dropped.
std::string disposition_file_name(std::string_view field);

}  // namespace server::api
