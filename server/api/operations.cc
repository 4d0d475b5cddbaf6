// /healthz, /readyz and /metrics: for supervisors, load balancers and monitoring.
#include <algorithm>

#include "proto/messages.h"
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/obs/metrics.h"
#include "server/version.h"

namespace server::api {
namespace {

using obs::MetricsText;

void write_data(const Context& context, MetricsText& text) {
  double vertices = 0;
  const auto tins = context.catalogue.list();
  for (const auto& tin : tins) {
    vertices += static_cast<double>(
        tin->read([](const auto& terrain, std::uint64_t) { return terrain.vertex_count(); }));
  }
  const obs::Metrics& counted = obs::metrics();
  text.family("tinsmith_tins", "gauge", "TINs that are served").sample("", static_cast<double>(tins.size()));
  text.family("tinsmith_vertices", "gauge", "Vertices of all TINs").sample("", vertices);
  text.family("tinsmith_edits_total", "counter", "Single operations of edits that were acknowledged")
      .sample("", static_cast<double>(counted.edits.load()));
  text.family("tinsmith_revisions_total", "counter", "Revisions that were acknowledged as durable")
      .sample("", static_cast<double>(counted.revisions.load()));
}

void write_queues(const Context& context, MetricsText& text) {
  const auto commits = context.catalogue.store().counts();
  text.family("tinsmith_commits_total", "counter", "Commits of the store")
      .sample("", static_cast<double>(commits.commits));
  text.family("tinsmith_committed_writes_total", "counter", "Writes that those commits made durable")
      .sample("", static_cast<double>(commits.writes));
  text.family("tinsmith_commit_seconds_total", "counter", "Time that commits took, syncs included")
      .sample("", commits.seconds);
  text.family("tinsmith_commit_queue", "gauge", "Writes that wait for a commit or its end")
      .sample("", static_cast<double>(commits.waiting));
  text.family("tinsmith_requests_in_work", "gauge", "Requests that hold one of the bounded places, by kind");
  const auto in_work = [&](const char* kind, const Slots& slots) {
    text.sample(MetricsText::label("kind", kind), static_cast<double>(slots.taken()));
  };
  in_work("edit", context.edits);
  in_work("upload", context.uploads);
  in_work("export", context.exports);
  in_work("waiting_for_job", context.waiting);
  in_work("change_stream", context.listeners);
}

void write_jobs(const Context& context, MetricsText& text) {
  const auto jobs = context.jobs.list();
  const auto count = [&](jobs::JobState state) {
    return static_cast<double>(
        std::count_if(jobs.begin(), jobs.end(), [&](const auto& j) { return j.state == state; }));
  };
  text.family("tinsmith_jobs", "gauge", "Jobs that wait, run, or are remembered, by state");
  text.sample(MetricsText::label("state", "accepted"), count(jobs::JobState::kAccepted));
  text.sample(MetricsText::label("state", "running"), count(jobs::JobState::kRunning));
  text.sample(MetricsText::label("state", "successful"), count(jobs::JobState::kSuccessful));
  text.sample(MetricsText::label("state", "failed"), count(jobs::JobState::kFailed));
  text.sample(MetricsText::label("state", "dismissed"), count(jobs::JobState::kDismissed));
  // A job's id is as good as a key to it, so jobs are numbered here.
  text.family("tinsmith_job_progress_ratio", "gauge", "How far each running job is");
  int number = 0;
  for (const auto& job : jobs) {
    if (job.state != jobs::JobState::kRunning) continue;
    text.sample(
        MetricsText::label("kind", job.kind) + "," + MetricsText::label("number", std::to_string(number++)),
        job.progress / 100.0);
  }
}

Response metrics_answer(const Context& context) {
  MetricsText text;
  text.family("tinsmith_build_info", "gauge", "Always 1").sample(MetricsText::label("version", version()), 1);
  obs::metrics().http.write(text);
  if (context.connections) {
    text.family("tinsmith_http_connections", "gauge", "Connections that are open")
        .sample("", static_cast<double>(context.connections()));
  }
  write_data(context, text);
  write_queues(context, text);
  write_jobs(context, text);
  const auto& memory = context.catalogue.memory();
  text.family("tinsmith_memory_estimate_bytes", "gauge",
              "Memory of terrains, their versions and jobs, estimated")
      .sample("", static_cast<double>(memory.used()));
  text.family("tinsmith_memory_limit_bytes", "gauge", "What that may be at most")
      .sample("", static_cast<double>(memory.limit()));
  text.family("process_resident_memory_bytes", "gauge", "Memory of the process in RAM")
      .sample("", static_cast<double>(obs::resident_bytes()));
  text.family("tinsmith_draining", "gauge", "1 while the server finishes before it stops")
      .sample("", context.draining ? 1 : 0);
  return {200,
          {{"Content-Type", "text/plain; version=0.0.4; charset=utf-8"}, {"Cache-Control", "no-store"}},
          text.take()};
}

Response readiness(Context& context) {
  if (context.draining) return error_pages().status(503, "The server is about to stop.");
  if (auto writable = context.catalogue.store().writable(); !writable)
    return error_pages().status(503, "The store takes no more writes: " + writable.error().message);
  Response ready = json_answer(proto::health_json("ready", version()));
  ready.headers.emplace_back("Cache-Control", "no-store");
  return ready;
}

}  // namespace

void add_operations(http::Router& router, Context& context) {
  using http::Method;
  using http::Need;
  router.add({.method = Method::kGet,
              .pattern = "/healthz",
              .need = Need::kNothing,
              .handler = guarded([](Request&) -> Result<Response> {
                return json_answer(proto::health_json("ok", version()));
              })});
  router.add({.method = Method::kGet,
              .pattern = "/readyz",
              .need = Need::kNothing,
              .handler = guarded([&context](Request&) -> Result<Response> { return readiness(context); })});
  router.add(
      {.method = Method::kGet,
       .pattern = "/metrics",
       .handler = guarded([&context](Request&) -> Result<Response> { return metrics_answer(context); })});
}

}  // namespace server::api
