// /jobs: list, status, results, dismissal (OGC API Processes).
#include <algorithm>
#include <chrono>

#include "proto/bbox.h"
#include "proto/datetime.h"
#include "server/api/job_answer.h"
#include "server/api/links.h"
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

Response no_such_job(std::string_view id) {
  return processes_exception(error(Code::kNotFound, "There is no job \"" + std::string(id) + "\"."), "no-such-job");
}

using jobs::JobStatus;

constexpr std::uint64_t kPageOfJobs = 100, kMostJobs = 10'000;

/// What a list of jobs is to hold (OGC API Processes, job list).
struct Selection {
  std::vector<std::string> processes;   // none: all
  std::vector<proto::JobState> states;  // none: all
  std::optional<proto::TimeSpan> created;
  std::optional<std::uint64_t> min_seconds, max_seconds;
  std::uint64_t limit = kPageOfJobs;
  std::optional<std::int64_t>
      before_ms;  // a page's place: jobs of that moment, from that id on, and earlier ones
  std::string from_id;

  bool has(const JobStatus& job, std::int64_t now_ms) const;
};

bool Selection::has(const JobStatus& job, std::int64_t now_ms) const {
  const auto among = [](const auto& list, const auto& value) {
    return list.empty() || std::find(list.begin(), list.end(), value) != list.end();
  };
  if (!among(processes, job.kind) || !among(states, state_of(job.state))) return false;
  if (created && !created->contains(job.created_ms)) return false;
  if (!min_seconds && !max_seconds) return true;
  if (!job.started_ms) return false;
  const double seconds = static_cast<double>(job.finished_ms.value_or(now_ms) - *job.started_ms) / 1000;
  return (!min_seconds || seconds >= static_cast<double>(*min_seconds)) &&
         (!max_seconds || seconds <= static_cast<double>(*max_seconds));
}

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    out.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

Result<std::optional<std::uint64_t>> count_of(const Request& request, const std::string& name,
                                              std::uint64_t least, std::uint64_t most) {
  const auto text = request.query_value(name);
  if (!text) return std::optional<std::uint64_t>();
  const auto count = proto::parse_count(*text, least, most, "query:" + name);
  if (!count) return error(Code::kMalformed, count.error().message, "query:" + name);
  return std::optional(*count);
}

/// "created.id" of the first job of the next page.
Result<void> read_place(const std::string& text, Selection& wanted) {
  const auto point = text.find('.');
  const auto moment = proto::parse_count(text.substr(0, point), 0, INT64_MAX, "query:next");
  if (point == std::string::npos || !moment)
    return error(Code::kMalformed, "This is no token that a page gave.", "query:next");
  wanted.before_ms = static_cast<std::int64_t>(*moment);
  wanted.from_id = text.substr(point + 1);
  return {};
}

Result<std::vector<proto::JobState>> states_of(std::string_view text) {
  std::vector<proto::JobState> states;
  for (const std::string& word : words(text)) {
    const auto state = proto::job_state(word);
    if (!state) {
      return error(Code::kMalformed, "A status is accepted, running, successful, failed or dismissed.",
                   "query:status");
    }
    states.push_back(*state);
  }
  return states;
}

Result<Selection> read_selection(const Request& request) {
  Selection wanted;
  if (const auto type = request.query_value("type"); type && *type != "process")
    return error(Code::kMalformed, "All jobs here are of the type process.", "query:type");
  if (const auto ids = request.query_value("processID")) wanted.processes = words(*ids);
  if (const auto text = request.query_value("status")) {
    auto states = states_of(*text);
    if (!states) return states.error();
    wanted.states = std::move(*states);
  }
  if (const auto text = request.query_value("datetime")) {
    const auto span = proto::parse_datetime(*text, "query:datetime");
    if (!span) return span.error();
    wanted.created = *span;
  }
  const auto least = count_of(request, "minDuration", 0, UINT32_MAX),
             most = count_of(request, "maxDuration", 0, UINT32_MAX),
             limit = count_of(request, "limit", 1, kMostJobs);
  if (!least) return least.error();
  if (!most) return most.error();
  if (!limit) return limit.error();
  wanted.min_seconds = *least;
  wanted.max_seconds = *most;
  wanted.limit = limit->value_or(kPageOfJobs);
  if (const auto text = request.query_value("next")) {
    if (auto place = read_place(*text, wanted); !place) return place.error();
  }
  return wanted;
}

std::string list_href(const Request& request, const JobStatus* next) {
  std::string href = "/jobs";
  const auto add = [&href](const std::string& name, std::string_view value) {
    href.append(href.size() == 5 ? "?" : "&").append(name).append("=").append(encoded(value));
  };
  for (const auto& [name, value] : request.query) {
    if (name != "next" || next == nullptr) add(name, value);
  }
  if (next != nullptr) add("next", std::to_string(next->created_ms) + "." + next->id);
  return href;
}

HtmlPage page_of(const std::vector<JobStatus>& shown, const std::vector<proto::Link>& links) {
  HtmlPage page{"Jobs",
                "Work that takes its time",
                links,
                {},
                {"id", "process", "status", "progress", "created", "what"},
                {}};
  for (const JobStatus& job : shown) {
    page.rows.push_back({job.id, job.kind, std::string(proto::job_state_name(state_of(job.state))),
                         std::to_string(job.progress) + " %", rfc3339(job.created_ms), job.description});
  }
  return page;
}

Result<Response> list(const Context& context, const Request& request) {
  const auto wanted = read_selection(request);
  if (!wanted) return wanted.error();
  const std::int64_t now = std::chrono::duration_cast<std::chrono::milliseconds>(
                               std::chrono::system_clock::now().time_since_epoch())
                               .count();
  std::vector<JobStatus> shown;
  std::optional<JobStatus> next;
  bool reached = !wanted->before_ms;
  for (auto& job : context.jobs.list()) {
    reached = reached || job.id == wanted->from_id || job.created_ms < *wanted->before_ms;
    if (!reached || !wanted->has(job, now)) continue;
    if (shown.size() == wanted->limit) {
      next = std::move(job);
      break;
    }
    shown.push_back(std::move(job));
  }
  std::vector<proto::JobStatus> documents;
  for (const JobStatus& job : shown) documents.push_back(job_document(job));
  std::vector<proto::Link> links{{list_href(request, nullptr), "self", std::string(kJson), ""},
                                 {list_href(request, nullptr), "alternate", "text/html", "As a page"}};
  if (next) links.push_back({list_href(request, &*next), "next", std::string(kJson), "Earlier jobs"});
  return negotiated(request, proto::job_list_json(documents, links), kJson, page_of(shown, links));
}

Result<Response> show(const Context& context, const Request& request) {
  const auto id = request.path_parameter("job");
  const auto job = context.jobs.status(id);
  if (!job) return no_such_job(id);
  const proto::JobStatus document = job_document(*job);
  HtmlPage page{"Job " + job->id, document.message, document.links, {}, {}, {}};
  page.facts = {{"Process", document.process},
                {"Status", std::string(proto::job_state_name(document.state))},
                {"Progress", std::to_string(document.progress) + " %"},
                {"Created", document.created}};
  return negotiated(request, proto::job_json(document), kJson, page);
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

Response job_accepted_answer(const jobs::JobQueue& queue, const jobs::JobId& id, const Request& request) {
  const auto job = queue.status(id);
  Response response = json_answer(job ? proto::job_json(job_document(*job)) : "{}", 201);
  response.headers.emplace_back("Location", "/jobs/" + id);
  if (prefers_async(request)) response.headers.emplace_back("Preference-Applied", "respond-async");
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
  return processes_exception(error(Code::kNotFound, "The job has not finished yet; ask for its status."), "result-not-ready");
}

void add_jobs(http::Router& router, Context& context) {
  using http::Method;
  router.add(
      {.method = Method::kGet,
       .pattern = "/jobs",
       .query = {"type", "processID", "status", "datetime", "minDuration", "maxDuration", "limit", "next"},
       .handler = guarded([&context](Request& r) { return list(context, r); })});
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
