// One request and what becomes of it, apart from its bytes on the wire. Knows no sockets.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "server/http/admission.h"
#include "server/http/answer.h"
#include "server/http/buffered.h"
#include "server/http/framing.h"
#include "server/http/session.h"

namespace server::http {

/// Threads: one at a time.
class Exchange {
 public:
  Exchange(SessionContext& shared, const std::string& peer);
  Exchange(Exchange&&) = delete;
  ~Exchange();  // removes the upload if nobody took it

  /// Takes the head and decides on it: see admission().
  void admit(Head& head);

  /// Says whether the connection is good for another request after this one; not, until it is said.
  void allow_keep_alive(bool allowed) { keep_alive_ = allowed; }

  /// Calls the handler and makes its answer. Requires: an admission without an answer, the body read.
  Answer handle();

  /// Makes the answer of a quick handler, if that gives one.
  std::optional<Answer> handle_quickly();

  /// Makes an answer without a handler.
  Answer reply(Response response);

  /// Counts what there is of the request's body as held. False: there is no room, and the admission's answer
  /// says so.
  bool hold_body();

  /// Whom the handler may ask whether somebody waits for it still.
  void set_attention(std::shared_ptr<Attention> attention) {
    admission_.request.attention = std::move(attention);
  }

  /// Reports to the observer what has been sent.
  void finish(const Answer& answer, bool whole);

  /// HTTP/1.0 has no 1xx.
  bool knows_interim_answers() const { return context_.minor == 1; }

  Admission& admission() { return admission_; }
  Access& access() { return access_; }

 private:
  void forget_request_body();
  Answer held(Answer answer);
  Response no_room() const;

  SessionContext& shared_;
  Admission admission_;
  AnswerContext context_;
  Access access_;
  Buffered buffered_;
  bool keep_alive_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace server::http
