#include "tin/terrain/edit.h"

namespace tin::terrain {

Change Change::inverse() const {
  Change undo;
  undo.cause = Cause::kRevert;
  undo.steps.reserve(steps.size());
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) undo.steps.push_back({step->id, step->after, step->before});
  return undo;
}

}  // namespace tin::terrain
