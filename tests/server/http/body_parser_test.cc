// Bodies and their framing, at once and in pieces of every size.
#include "server/http/body_parser.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>

namespace tests::server_http {
namespace {

using server::http::BodyParser;
using server::http::Head;
using State = BodyParser::State;

Head chunked() {
  Head head;
  head.chunked = true;
  return head;
}

struct Outcome {
  State state;
  std::string body;
  std::size_t used;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

Outcome parse(const Head& head, std::string_view bytes, std::size_t step, std::uint64_t limit = 100,
              std::size_t framing = 50) {
  BodyParser parser(head);
  parser.set_limits(limit, framing);
  Outcome outcome{State::kNeedMore, "", 0};
  std::array<char, 7> block{};
  std::size_t given = 0;
  while (outcome.state == State::kNeedMore || outcome.state == State::kAgain) {
    if (outcome.state == State::kNeedMore && given == bytes.size() && given > 0) return outcome;
    if (outcome.state == State::kNeedMore) given = std::min(bytes.size(), given + step);
    const auto result = parser.parse(bytes.substr(outcome.used, given - outcome.used), block);
    outcome.state = result.state;
    outcome.used += result.used;
    outcome.body.append(block.data(), result.filled);
  }
  EXPECT_EQ(parser.done(), outcome.state == State::kDone);
  return outcome;
}

/// The outcome, the same for pieces of every size.
Outcome outcome_of(const Head& head, const std::string& bytes, std::uint64_t limit = 100,
                   std::size_t framing = 50) {
  const Outcome whole = parse(head, bytes, bytes.size() + 1, limit, framing);
  for (std::size_t step = 1; step <= bytes.size(); ++step)
    EXPECT_EQ(parse(head, bytes, step, limit, framing), whole) << bytes << step;
  return whole;
}

TEST(BodyParserTest, ALengthSaysWhereTheBodyEnds) {
  Head head;
  head.content_length = 11;
  EXPECT_EQ(outcome_of(head, "hello worldGET /"), (Outcome{State::kDone, "hello world", 11}));
  EXPECT_EQ(outcome_of(head, "hello").state, State::kNeedMore);
  head.content_length = 0;
  EXPECT_TRUE(BodyParser(head).done());
  EXPECT_TRUE(BodyParser(Head{}).done());
}

TEST(BodyParserTest, ChunksArePutTogether) {
  const std::string bytes = "5\r\nhello\r\n006;a=\"b\"\r\n world\r\n0\r\nX-Sum: 1\r\nY:\r\n\r\n";
  EXPECT_EQ(outcome_of(chunked(), bytes + "GET /"), (Outcome{State::kDone, "hello world", bytes.size()}));
  EXPECT_EQ(outcome_of(chunked(), "0\r\n\r\n"), (Outcome{State::kDone, "", 5}));
  EXPECT_EQ(outcome_of(chunked(), "A\r\n0123456789\r\n0;x\r\n\r\n").body, "0123456789");
}

/// Found by fuzz_http: Beast takes the end of the line into the quoted string when all comes at once.
TEST(BodyParserTest, AnOpenQuotationMarkIsRefused) {
  EXPECT_EQ(outcome_of(chunked(), "5;a=\"\r\nhello\r\n0\r\n\r\n").state, State::kBroken);
}

TEST(BodyParserTest, ExtensionsAreReadStrictly) {
  for (const char* good : {"1;a", "1;a;b", "1;a=b", "1; a = \"b;c\\\"\" ;d", "1;a=\"\""}) {
    EXPECT_EQ(outcome_of(chunked(), std::string(good) + "\r\nx\r\n0\r\n\r\n").body, "x") << good;
  }
  for (const char* bad : {"1;", "1;;a", "1;a=", "1;\"a\"", "1;a=\"b\"c", "1;a b", "1;a=\"b\\\"", "1;=b"}) {
    EXPECT_EQ(outcome_of(chunked(), std::string(bad) + "\r\nx\r\n0\r\n\r\n").state, State::kBroken) << bad;
  }
  const std::string longest = "1;" + std::string(1024, 'a');
  EXPECT_EQ(parse(chunked(), longest + "\r\nx\r\n0\r\n\r\n", 5000, 100, 5000).state, State::kDone);
  EXPECT_EQ(parse(chunked(), longest + "a\r\nx\r\n0\r\n\r\n", 5000, 100, 5000).state, State::kBroken);
}

TEST(BodyParserTest, WhatIsNoChunkIsBroken) {
  for (const char* bytes : {"g\r\n",
                            "\r\n",
                            ";a\r\n",
                            " 1\r\nx\r\n",
                            "1 \r\nx\r\n",
                            "-1\r\n",
                            "+1\r\n",
                            "0x1\r\n",
                            "1\n",
                            "1\rx",
                            "1\r\nxy\r\n",
                            "1\r\nx\n",
                            "1\r\nx\r\r",
                            "1;\x01\r\nx\r\n",
                            "1;\x7f\r\nx\r\n",
                            "1;a\nb\r\nx\r\n",
                            "0\n",
                            "0\r\nX\r\n\r\n",
                            "0\r\n: 1\r\n\r\n",
                            "0\r\n X: 1\r\n\r\n",
                            "0\r\nX : 1\r\n\r\n",
                            "0\r\nX: a\rb\r\n\r\n",
                            "0\r\nX: a\n\r\n\r\n",
                            "00000000000000001\r\nx\r\n",
                            "1;\xc3\xa9\r\nx\r\n"}) {
    EXPECT_EQ(outcome_of(chunked(), bytes).state, State::kBroken) << bytes;
  }
}

TEST(BodyParserTest, LimitsHoldAtTheirValueAndNotOnePast) {
  EXPECT_EQ(outcome_of(chunked(), "5\r\nhello\r\n5\r\nworld\r\n0\r\n\r\n", 10).state, State::kDone);
  EXPECT_EQ(outcome_of(chunked(), "5\r\nhello\r\n6\r\nworlds\r\n0\r\n\r\n", 10).state, State::kTooLarge);
  EXPECT_EQ(outcome_of(chunked(), "ffffffffffffffff\r\n", 10).state, State::kTooLarge);
  EXPECT_EQ(outcome_of(chunked(), "1;12345\r\nx\r\n0\r\n\r\n", 10, 5).state, State::kDone);
  EXPECT_EQ(outcome_of(chunked(), "1;123456\r\nx\r\n0\r\n\r\n", 10, 5).state, State::kBroken);
  EXPECT_EQ(outcome_of(chunked(), "1\r\nx\r\n0\r\nA: 12\r\n\r\n", 10, 5).state, State::kDone);
  EXPECT_EQ(outcome_of(chunked(), "1\r\nx\r\n0\r\nA: 123\r\n\r\n", 10, 5).state, State::kBroken);
  Head head;
  head.content_length = 10;
  EXPECT_EQ(outcome_of(head, "0123456789", 10).state, State::kDone);
  EXPECT_EQ(outcome_of(head, "0123456789", 9).state, State::kTooLarge);
}

}  // namespace
}  // namespace tests::server_http
