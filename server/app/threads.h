// How many threads the engine takes for one piece of work: a build or a simplification.
#pragma once

#include <algorithm>
#include <thread>

namespace server::app {

/// The processor's. What is made does not depend on it.
inline unsigned engine_threads() {
  return std::max(1U, std::thread::hardware_concurrency());
}

}  // namespace server::app
