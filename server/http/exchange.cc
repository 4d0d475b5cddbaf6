#include "server/http/exchange.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace server::http {
namespace {

/// Whether a client's own request id may stand in our log and answers: a proxy's, or a trace's.
bool may_be_id(std::string_view id) {
  constexpr std::size_t kMostBytes = 128;
  constexpr std::string_view kSymbols = "-_.:/+=@";
  return !id.empty() && id.size() <= kMostBytes && std::all_of(id.begin(), id.end(), [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           kSymbols.find(c) != std::string_view::npos;
  });
}

}  // namespace

Exchange::Exchange(SessionContext& shared, const std::string& peer)
    : shared_(shared), buffered_(shared.buffered, shared.options.buffered_bytes) {
  context_.request_id = shared_.id_prefix + std::to_string(++shared_.requests);
  access_.request_id = context_.request_id;
  access_.peer = peer;
}

Exchange::~Exchange() {
  forget_request_body();
}

void Exchange::forget_request_body() {
  Request& request = admission_.request;
  std::error_code ignored;
  if (!request.body_file.empty()) std::filesystem::remove(request.body_file, ignored);
  request.body_file.clear();
  request.body = std::string();
  buffered_.resize(0);
}

Response Exchange::no_room() const {
  return shared_.pages.status(503, "the requests and answers under way take all the memory that they may");
}

bool Exchange::hold_body() {
  if (buffered_.resize(admission_.request.body.size())) return true;
  forget_request_body();
  admission_.answer = no_room();
  return false;
}

/// The answer, or that there is no memory to keep it until the client has taken it. What has changed something is
/// answered in any case: a refusal would not be true.
Answer Exchange::held(Answer answer) {
  const Route& route = *admission_.route;
  const bool reads = route.need == Need::kRead || route.method == Method::kGet;
  if (!reads) buffered_.force(answer.body.size());
  if (!reads || buffered_.resize(answer.body.size())) return answer;
  return reply(no_room());
}

void Exchange::admit(Head& head) {
  context_.method = head.method;
  context_.minor = head.minor;
  access_.method = method_name(head.method);
  for (const auto& [name, value] : head.headers) {
    if (name == "x-request-id" && may_be_id(value)) context_.request_id = access_.request_id = value;
  }
  admission_ = http::admit(head, context_.request_id, shared_.router, shared_.pages, shared_.options);
  access_.path = admission_.request.path;
  access_.client = admission_.request.client;
  if (admission_.route != nullptr) access_.route = admission_.route->pattern;
  context_.if_none_match = admission_.request.header("if-none-match");
  context_.accept_encoding = admission_.request.header("accept-encoding");
  context_.compress_from = shared_.options.compress_from_bytes;
}

std::optional<Answer> Exchange::handle_quickly() {
  std::optional<Response> response = call_quick_handler(*admission_.route, admission_.request);
  if (!response) return std::nullopt;
  return held(reply(*std::move(response)));
}

Answer Exchange::handle() {
  Response response = call_handler(*admission_.route, admission_.request, shared_.pages, shared_.observer);
  forget_request_body();
  try {
    return held(reply(std::move(response)));
  } catch (const std::exception& e) {
    if (shared_.observer.problem) {
      shared_.observer.problem(context_.request_id, std::string("the answer could not be made: ") + e.what());
    }
    return reply(shared_.pages.status(500, "the server failed to answer this request"));
  }
}

Answer Exchange::reply(Response response) {
  context_.keep_alive = keep_alive_ && !shared_.draining;
  return make_answer(std::move(response), context_);
}

void Exchange::finish(const Answer& answer, bool whole) {
  buffered_.resize(0);
  if (!shared_.observer.access) return;
  access_.status = answer.status;
  access_.cut = !whole;
  access_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  shared_.observer.access(access_);
}

}  // namespace server::http
