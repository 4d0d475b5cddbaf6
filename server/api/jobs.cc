// /jobs: list, status, results, dismissal (OGC API Processes).
#include "server/api/job_answer.h"
#include "server/api/routes.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

proto::JobState state_of(jobs::JobState state) {
  switch (state) {
    case jobs::JobState::kAccepted:
      return proto::JobState::kAccepted;
    case jobs::JobState::kRunning:
      return proto::JobState::kRunning;
    case jobs::JobState::kSuccessful:
      return proto::JobState::kSuccessful;
    case jobs::JobState::kFailed:
      return proto::JobState::kFailed;
    case jobs::JobState::kDismissed:
      break;
  }
  return proto::JobState::kDismissed;
}

tin::base::Error no_such_job(std::string_view id) {
  return error(Code::kNotFound, "There is no job \"" + std::string(id) + "\".");
}

Result<Response> list(const Context& context) {
  std::vector<proto::JobStatus> documents;
  for (const auto& job : context.jobs.list()) documents.push_back(job_document(job));
  const std::vector<proto::Link> links{{"/jobs", "self", std::string(kJson), ""}};
  return json_answer(proto::job_list_json(documents, links));
}

Result<Response> show(const Context& context, const Request& request) {
  const auto id = request.path_parameter("job");
  const auto job = context.jobs.status(id);
  if (!job) return no_such_job(id);
  return json_answer(proto::job_json(job_document(*job)));
}

Result<Response> results(const Context& context, const Request& request) {
  const auto id = request.path_parameter("job");
  const auto job = context.jobs.status(id);
  if (!job) return no_such_job(id);
  return job_result_answer(*job);
}

Result<Response> dismiss(Context& context, const Request& request) {
  const auto id = request.path_parameter("job");
  if (auto dismissed = context.jobs.dismiss(id); !dismissed) return no_such_job(id);
  // Work stops within milliseconds; waiting for that makes the answer definite.
  const auto job = context.jobs.wait(id, std::chrono::seconds(5));
  if (!job) return no_such_job(id);
  return json_answer(proto::job_json(job_document(*job)));
}

}  // namespace

proto::JobStatus job_document(const jobs::JobStatus& job) {
  proto::JobStatus document{
      job.id, job.kind, state_of(job.state), job.progress, rfc3339(job.created_ms), "", "", job.message, {}};
  if (job.started_ms) document.started = rfc3339(*job.started_ms);
  if (job.finished_ms) document.finished = rfc3339(*job.finished_ms);
  if (job.error) document.message = job.error->message;
  document.message = job.description + ": " + document.message;
  document.links.push_back({"/jobs/" + job.id, "self", std::string(kJson), ""});
  if (job.state == jobs::JobState::kSuccessful) {
    document.links.push_back({"/jobs/" + job.id + "/results",
                              "http://www.opengis.net/def/rel/ogc/1.0/results", std::string(kJson), ""});
  }
  return document;
}

Response job_accepted_answer(const jobs::JobQueue& queue, const jobs::JobId& id) {
  const auto job = queue.status(id);
  Response response = json_answer(job ? proto::job_json(job_document(*job)) : "{}", 201);
  response.headers.emplace_back("Location", "/jobs/" + id);
  response.headers.emplace_back("Preference-Applied", "respond-async");
  return response;
}

Result<Response> job_result_answer(const jobs::JobStatus& job) {
  switch (job.state) {
    case jobs::JobState::kSuccessful:
      return json_answer(job.result);
    case jobs::JobState::kFailed:
      return *job.error;
    case jobs::JobState::kDismissed:
      return error(Code::kGone, "The job was dismissed.");
    case jobs::JobState::kAccepted:
    case jobs::JobState::kRunning:
      break;
  }
  return error(Code::kNotFound, "The job has not finished yet; ask for its status.");
}

void add_jobs(http::Router& router, Context& context) {
  using http::Method;
  router.add({.method = Method::kGet, .pattern = "/jobs", .handler = guarded([&context](Request&) {
                                                            return list(context);
                                                          })});
  router.add({.method = Method::kGet, .pattern = "/jobs/{job}", .handler = guarded([&context](Request& r) {
                                                                  return show(context, r);
                                                                })});
  router.add({.method = Method::kDelete, .pattern = "/jobs/{job}", .handler = guarded([&context](Request& r) {
                                                                     return dismiss(context, r);
                                                                   })});
  router.add({.method = Method::kGet,
              .pattern = "/jobs/{job}/results",
              .handler = guarded([&context](Request& r) { return results(context, r); })});
}

}  // namespace server::api
