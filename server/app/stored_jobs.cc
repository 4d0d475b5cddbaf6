#include "server/app/stored_jobs.h"

#include <array>
#include <utility>

#include "server/obs/log.h"

namespace server::app {

using tin::base::Code;
using tin::base::Result;

namespace {

// Names, not numbers: they mean the same in every version of the program.
constexpr std::array<std::pair<Code, std::string_view>, 18> kCodes{{
    {Code::kMalformed, "malformed"},
    {Code::kUnknownParameter, "unknown-parameter"},
    {Code::kNotFound, "not-found"},
    {Code::kUnknownVertex, "unknown-vertex"},
    {Code::kNotFinite, "not-finite"},
    {Code::kOutsideLattice, "outside-lattice"},
    {Code::kDuplicatePosition, "duplicate-position"},
    {Code::kInvalidValue, "invalid-value"},
    {Code::kUnsupported, "unsupported"},
    {Code::kConflict, "conflict"},
    {Code::kPrecondition, "precondition"},
    {Code::kGone, "gone"},
    {Code::kTooLarge, "too-large"},
    {Code::kTooMany, "too-many"},
    {Code::kCancelled, "cancelled"},
    {Code::kStorage, "storage"},
    {Code::kNoSpace, "no-space"},
    {Code::kInternal, "internal"},
}};

std::string name_of(Code code) {
  for (const auto& [known, name] : kCodes) {
    if (known == code) return std::string(name);
  }
  return "internal";
}

Code code_named(std::string_view name) {
  for (const auto& [code, known] : kCodes) {
    if (known == name) return code;
  }
  return Code::kInternal;
}

store::JobRow row_of(const jobs::JobStatus& job) {
  store::JobRow row{job.id,
                    job.kind,
                    job.description,
                    static_cast<std::int64_t>(job.state),
                    job.created_ms,
                    job.started_ms.value_or(0),
                    job.finished_ms.value_or(0),
                    job.message,
                    "",
                    "",
                    job.result};
  if (job.error) {
    row.error = name_of(job.error->code);
    row.message = job.error->message;
    row.where = job.error->where;
  }
  return row;
}

jobs::JobStatus status_of(const store::JobRow& row) {
  jobs::JobStatus job;
  job.id = row.id;
  job.kind = row.kind;
  job.description = row.description;
  job.state = static_cast<jobs::JobState>(row.state);
  job.created_ms = row.created_ms;
  if (row.started_ms != 0) job.started_ms = row.started_ms;
  if (row.finished_ms != 0) job.finished_ms = row.finished_ms;
  job.message = row.message;
  job.result = row.result;
  if (!row.error.empty()) job.error = tin::base::error(code_named(row.error), row.message, row.where);
  return job;
}

}  // namespace

Result<std::vector<jobs::JobStatus>> StoredJobs::recall() {
  const auto rows = store_.list_jobs();
  if (!rows) return rows.error();
  std::vector<jobs::JobStatus> jobs;
  for (const store::JobRow& row : *rows) jobs.push_back(status_of(row));
  return jobs;
}

Result<void> StoredJobs::remember(const jobs::JobStatus& job) {
  auto kept = store_.put_job(row_of(job));
  if (!kept) obs::log_warning("job_not_kept", {{"job", job.id}, {"message", kept.error().message}});
  return kept;
}

void StoredJobs::forget(const jobs::JobId& id) {
  if (auto gone = store_.remove_job(id); !gone)
    obs::log_warning("job_not_forgotten", {{"job", id}, {"message", gone.error().message}});
}

}  // namespace server::app
