#include "server/http/exchange.h"

#include <filesystem>
#include <system_error>

namespace server::http {

Exchange::Exchange(SessionContext& shared, const std::string& peer) : shared_(shared) {
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
}

void Exchange::admit(Head& head) {
  context_.method = head.method;
  context_.minor = head.minor;
  access_.method = method_name(head.method);
  admission_ = http::admit(head, context_.request_id, shared_.router, shared_.pages, shared_.options);
  admission_.request.aborted = &shared_.aborted;
  access_.path = admission_.request.path;
  if (admission_.route != nullptr) access_.route = admission_.route->pattern;
  context_.if_none_match = admission_.request.header("if-none-match");
}

Answer Exchange::handle() {
  Response response = call_handler(*admission_.route, admission_.request, shared_.pages, shared_.observer);
  forget_request_body();
  try {
    return reply(std::move(response));
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
  if (!shared_.observer.access) return;
  access_.status = answer.status;
  access_.cut = !whole;
  access_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  shared_.observer.access(access_);
}

}  // namespace server::http
