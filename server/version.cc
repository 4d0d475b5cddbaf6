#include "server/version.h"

namespace server {

std::string_view version() {
  return TINSMITH_VERSION;
}

}  // namespace server
