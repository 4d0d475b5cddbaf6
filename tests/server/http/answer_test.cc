#include "server/http/answer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace tests::server_http {
namespace {

using server::http::Answer;
using server::http::AnswerContext;
using server::http::BodySource;
using server::http::FileBody;
using server::http::Framing;
using server::http::make_answer;
using server::http::Method;
using server::http::none_match_hits;
using server::http::Response;

class Nothing : public BodySource {
 public:
  bool next(std::string&) override { return false; }
};

Answer answer_to(const AnswerContext& context, Response response) {
  return make_answer(std::move(response), context);
}

bool states(const Answer& answer, const std::string& line) {
  return answer.head.find("\r\n" + line + "\r\n") != std::string::npos;
}

TEST(AnswerTest, TagsAreComparedWeakly) {
  EXPECT_TRUE(none_match_hits("\"a\"", "\"a\""));
  EXPECT_TRUE(none_match_hits("\"x,y\", W/\"a\"", "\"a\""));
  EXPECT_TRUE(none_match_hits("\"a\"", "W/\"a\""));
  EXPECT_TRUE(none_match_hits(" *", "\"a\""));
  EXPECT_FALSE(none_match_hits("*", ""));
  EXPECT_FALSE(none_match_hits("\"x, \"a\"\"", "\"b\""));
  EXPECT_FALSE(none_match_hits("a", "a"));
  EXPECT_FALSE(none_match_hits("\"a", "\"a"));
  EXPECT_FALSE(none_match_hits("", "\"a\""));
}

TEST(AnswerTest, AHandlerCannotBeginANewLine) {
  const Answer answer = answer_to({}, {200, {{"Location", "/a\r\nSet-Cookie: x"}}, "b"});
  EXPECT_TRUE(states(answer, "Location: /a  Set-Cookie: x"));
}

TEST(AnswerTest, FramingBelongsToTheServer) {
  const Answer answer = answer_to(
      {}, {200, {{"Content-Length", "99"}, {"Transfer-Encoding", "x"}, {"Connection", "y"}}, "four"});
  EXPECT_TRUE(states(answer, "Content-Length: 4"));
  EXPECT_EQ(answer.head.find("99"), std::string::npos);
  EXPECT_EQ(answer.head.find("Transfer-Encoding"), std::string::npos);
  EXPECT_EQ(answer.head.find("Connection"), std::string::npos);
}

TEST(AnswerTest, OldClientsGetTheEndOfTheConnectionAsTheEndOfTheBody) {
  AnswerContext old;
  old.minor = 0;
  const Answer streamed = answer_to(old, {200, {}, std::make_unique<Nothing>()});
  EXPECT_EQ(streamed.framing, Framing::kClose);
  EXPECT_TRUE(states(streamed, "Connection: close"));
  EXPECT_TRUE(states(answer_to(old, {200, {}, "x"}), "Connection: keep-alive"));
}

TEST(AnswerTest, UnchangedContentIsNotSentAgain) {
  AnswerContext context;
  context.if_none_match = "\"1\"";
  const Answer answer =
      answer_to(context, {200, {{"ETag", "\"1\""}, {"Content-Type", "a/b"}, {"Vary", "Accept"}}, "x"});
  EXPECT_EQ(answer.status, 304);
  EXPECT_EQ(answer.framing, Framing::kNone);
  EXPECT_TRUE(states(answer, "ETag: \"1\""));
  EXPECT_TRUE(states(answer, "Vary: Accept"));
  EXPECT_EQ(answer.head.find("Content-"), answer.head.find("Content-Crs"));
  EXPECT_EQ(answer_to(context, {404, {{"ETag", "\"1\""}}, "x"}).status, 404);
  context.method = Method::kPost;
  EXPECT_EQ(answer_to(context, {200, {{"ETag", "\"1\""}}, "x"}).status, 200);
}

TEST(AnswerTest, AFileIsRemovedEvenIfItIsNotSent) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "answer-test-file";
  const auto make = [&] { std::ofstream(path) << "12345"; };
  make();
  EXPECT_TRUE(states(answer_to({}, {200, {}, FileBody{path, true}}), "Content-Length: 5"));
  EXPECT_FALSE(std::filesystem::exists(path));
  make();
  AnswerContext context;
  context.if_none_match = "*";
  EXPECT_EQ(answer_to(context, {200, {{"ETag", "\"1\""}}, FileBody{path, true}}).status, 304);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THROW(answer_to({}, {200, {}, FileBody{path, true}}), std::system_error);
}

}  // namespace
}  // namespace tests::server_http
