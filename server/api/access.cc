#include "server/api/access.h"

#include <memory>

#include "server/api/answer.h"
#include "server/http/router.h"

namespace server::api {
namespace {

using http::Need;

Need need_of(const http::Route& route) {
  if (route.need != Need::kByMethod) return route.need;
  return route.method == http::Method::kGet ? Need::kRead : Need::kWrite;
}

/// RFC 6750, section 3.
Response refusal(int status, const std::string& detail, const std::string& challenge) {
  Response response = error_pages().status(status, detail);
  response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"tinsmith\"" + challenge);
  return response;
}

std::optional<Response> judge(const auth::Tokens& tokens, bool anonymous_read, Request& request,
                              const http::Route& route) {
  const Need need = need_of(route);
  if (need == Need::kNothing) return std::nullopt;
  const std::string_view field = request.header("authorization");
  if (field.empty()) {
    if (need == Need::kRead && anonymous_read) return std::nullopt;
    return refusal(401, "This needs a token: Authorization: Bearer ...", "");
  }
  const auto token = auth::bearer_token(field);
  const auth::Grant* grant = token ? tokens.find(*token) : nullptr;
  if (grant == nullptr) return refusal(401, "The token is not known here.", ", error=\"invalid_token\"");
  request.client = grant->name;
  if (need == Need::kRead ? grant->read : grant->write) return std::nullopt;
  const std::string scope = need == Need::kRead ? "read" : "write";
  return refusal(403, "The token does not have the scope \"" + scope + "\".",
                 ", error=\"insufficient_scope\", scope=\"" + scope + "\"");
}

}  // namespace

http::Gate make_gate(auth::Tokens tokens, bool anonymous_read) {
  if (tokens.empty()) return {};
  return [tokens = std::make_shared<const auth::Tokens>(std::move(tokens)), anonymous_read](
             Request& request, const http::Route& route) {
    return judge(*tokens, anonymous_read, request, route);
  };
}

}  // namespace server::api
