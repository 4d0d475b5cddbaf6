// The table of processes: what OGC API Processes serves under /processes.
//
// A process is a function of this folder that returns its entry; processes() lists them all. To add one: its
// description, inputs and results in proto/processes/NAME.h, its entry in server/api/processes/NAME.cc, a line
// in table.cc, and its schemas beside the others under /processes/{process}/execution in proto/openapi.json.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "proto/processes/process.h"
#include "server/api/routes.h"
#include "server/jobs/job_queue.h"
#include "tin/base/result.h"

namespace server::api::processes {

/// One execution, ready to run.
struct Execution {
  std::string subject;        // what it is about, for the list of jobs: a TIN's id
  jobs::JobQueue::Work work;  // gives the value of the output "result" as JSON
};

struct Process {
  const proto::ProcessDescription* description = nullptr;
  /// Checks the inputs as far as that is quick. What it returns may outlive the inputs, not the context.
  /// Errors: at "/inputs/...".
  std::function<tin::base::Result<Execution>(Context&, const proto::Value& inputs)> prepare;
};

/// All of them, in the order in which they are listed.
std::span<const Process> processes();

/// Null when there is none of that id.
const Process* find_process(std::string_view id);

/// The TIN that an input names. Errors: kNotFound at `where`.
tin::base::Result<std::shared_ptr<app::Tin>> find_input_tin(const Context& context, std::string_view id,
                                                            std::string where = "/inputs/tin");
/// Whether a TIN of the id may be made. Errors: as app::Catalogue::check_room, at `where`.
tin::base::Result<void> check_new_tin(const Context& context, const std::optional<std::string>& id,
                                      std::string where = "/inputs/as");

// One function per file of this folder.
Process simplify();
Process contours();
Process volume();
Process cut_fill();
Process surface_area();
Process profile();
Process line_of_sight();

}  // namespace server::api::processes
