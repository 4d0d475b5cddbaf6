// Jobs as clients see them.
#pragma once

#include "proto/messages.h"
#include "server/api/answer.h"
#include "server/jobs/job_queue.h"

namespace server::api {

proto::JobStatus job_document(const jobs::JobStatus& job);

/// 201 with Location and the job's status; with Preference-Applied when the request asked not to wait (RFC
/// 7240: a preference that nobody stated was not applied).
Response job_accepted_answer(const jobs::JobQueue& queue, const jobs::JobId& id, const Request& request);

/// What a finished job came to: its result, or its error as a problem. Errors: kNotFound when it has not
/// finished, kGone when it was dismissed.
Result<Response> job_result_answer(const jobs::JobStatus& job);

}  // namespace server::api
