// /processes: the table of processes, and their execution as jobs (OGC API Processes).
#include "proto/bbox.h"
#include "server/api/answer.h"
#include "server/api/job_answer.h"
#include "server/api/links.h"
#include "server/api/processes/process.h"
#include "server/api/routes.h"

namespace server::api {

using processes::Process;
using tin::base::Code;
using tin::base::error;

namespace {

Response no_such_process(std::string_view id) {
  return processes_exception(error(Code::kNotFound, "There is no process \"" + std::string(id) + "\"."), "no-such-process");
}

Result<Response> list(Context&, const Request& request) {
  constexpr std::uint64_t kMost = 1000;
  std::uint64_t limit = kMost;
  if (const auto text = request.query_value("limit")) {
    const auto parsed = proto::parse_count(*text, 1, kMost, "query:limit");
    if (!parsed) return error(Code::kMalformed, parsed.error().message, "query:limit");
    limit = *parsed;
  }
  std::vector<const proto::ProcessDescription*> descriptions;
  for (const Process& process : processes::processes()) {
    if (descriptions.size() < limit) descriptions.push_back(process.description);
  }
  HtmlPage page{"Processes", "What can be done with a TIN as a job", {}, {}, {}, {}};
  for (const auto* process : descriptions)
    page.links.push_back({"/processes/" + std::string(process->id), "item", "", std::string(process->title)});
  return negotiated(request, proto::process_list_json(descriptions), kJson, page);
}

HtmlPage page_of(const proto::ProcessDescription& process) {
  HtmlPage page{std::string(process.title), std::string(process.description), {}, {}, {}, {}};
  page.facts = {{"Inputs", std::string(process.inputs)}, {"Result", std::string(process.result_title)}};
  page.links.push_back({"/processes", "up", std::string(kJson), "All processes"});
  return page;
}

Result<Response> show(Context&, const Request& request) {
  const auto id = request.path_parameter("process");
  const Process* process = processes::find_process(id);
  if (process == nullptr) return no_such_process(id);
  return negotiated(request, proto::process_json(*process->description), kJson,
                    page_of(*process->description));
}

/// The work of an execution whose result stands in a document.
jobs::JobQueue::Work in_document(jobs::JobQueue::Work work) {
  return [work = std::move(work)](tin::base::Progress& progress) -> Result<std::string> {
    const auto result = work(progress);
    if (!result) return result.error();
    return proto::result_document(*result);
  };
}

/// Waits for the job as long as the client does, at most for the time that the configuration says. A job
/// whose client is gone is dismissed: nobody knows its id. Nothing: it has not finished.
std::optional<jobs::JobStatus> finished_in_time(Context& context, const jobs::JobId& job,
                                                const Request& request) {
  constexpr std::chrono::milliseconds kAskEvery{200};
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(context.config.jobs.sync_seconds);
  while (std::chrono::steady_clock::now() < end) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    const auto status = context.jobs.wait(job, std::min(left, kAskEvery));
    if (!status || status->finished_ms) return status;
    if (!request.is_aborted()) continue;
    static_cast<void>(context.jobs.dismiss(job));  // it may have been forgotten by now
    return context.jobs.status(job);
  }
  return std::nullopt;
}

Result<Response> execute(Context& context, const Request& request) {
  const auto id = request.path_parameter("process");
  const Process* process = processes::find_process(id);
  if (process == nullptr) return no_such_process(id);
  if (auto json = require_json(request); !json) return json.error();
  const auto asked = proto::ExecutionRequest::read(request.body);
  if (!asked) return asked.error();
  auto execution = process->prepare(context, asked->inputs());
  if (!execution) return execution.error();
  auto work = asked->as_document() ? in_document(std::move(execution->work)) : std::move(execution->work);
  const auto job = context.jobs.submit(std::string(id), std::move(execution->subject), std::move(work));
  if (!job) return job.error();
  const Slot slot(context.waiting);
  if (!prefers_async(request) && slot.taken()) {
    const auto finished = finished_in_time(context, *job, request);
    if (finished && finished->finished_ms) return job_result_answer(*finished);
  }
  return job_accepted_answer(context.jobs, *job, request);
}

}  // namespace

void add_processes(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  router.add({.method = Method::kGet, .pattern = "/processes", .query = {"limit"}, .handler = on(list)});
  router.add({.method = Method::kGet, .pattern = "/processes/{process}", .handler = on(show)});
  router.add({.method = Method::kPost,
              .pattern = "/processes/{process}/execution",
              .body = http::BodyKind::kMemory,
              .handler = on(execute)});
}

}  // namespace server::api
