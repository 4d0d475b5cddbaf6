#include "tin/terrain/edit.h"

namespace tin::terrain {

namespace {

Cause inverse_of(Cause cause) {
  switch (cause) {
    case Cause::kEdit:
      return Cause::kUndo;
    case Cause::kSimplification:
      return Cause::kRevert;
    case Cause::kRevert:
      return Cause::kSimplification;
    case Cause::kUndo:
      break;
  }
  return Cause::kEdit;
}

}  // namespace

Change Change::inverse() const {
  Change undo;
  undo.cause = inverse_of(cause);
  undo.steps.reserve(steps.size());
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) undo.steps.push_back({step->id, step->after, step->before});
  return undo;
}

}  // namespace tin::terrain
