#include <algorithm>
#include <vector>

#include "server/api/processes/process.h"

namespace server::api::processes {

using tin::base::error;
using tin::base::Result;

std::span<const Process> processes() {
  static const std::vector<Process> table{simplify(), contours(), volume(),       cut_fill(),
                                          surface_area(), profile(), line_of_sight()};
  return table;
}

const Process* find_process(std::string_view id) {
  const auto table = processes();
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Process& p) { return p.description->id == id; });
  return found == table.end() ? nullptr : &*found;
}

Result<std::shared_ptr<app::Tin>> find_input_tin(const Context& context, std::string_view id,
                                                 std::string where) {
  auto tin = context.catalogue.find(id);
  if (!tin) return error(tin.error().code, tin.error().message, std::move(where));
  return tin;
}

Result<void> check_new_tin(const Context& context, const std::optional<std::string>& id, std::string where) {
  const auto room = context.catalogue.check_room(id);
  return room ? Result<void>() : error(room.error().code, room.error().message, std::move(where));
}

}  // namespace server::api::processes
