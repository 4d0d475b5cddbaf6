#include "server/cli/token.h"

#include <cstdio>

#include "server/auth/tokens.h"
#include "server/obs/log.h"

namespace server::cli {

int print_token(const TokenArguments& arguments) {
  if (arguments.name.empty()) {
    std::fprintf(stderr, "tinsmith: a token needs a name\n");
    return 2;
  }
  const std::string token = auth::make_token();
  const std::string hash = auth::hash_token(token);
  std::printf("The token, for the client; it is not kept anywhere:\n\n  %s\n\n", token.c_str());
  std::printf(
      "Its entry in \"auth\": {\"tokens\": [ ... ]} of the configuration:\n\n  {%s, \"hash\": \"%s\", "
      "\"scopes\": [%s]}\n",
      obs::log_pair("name", arguments.name).c_str(), hash.c_str(),
      arguments.write ? "\"read\", \"write\"" : "\"read\"");
  return 0;
}

}  // namespace server::cli
