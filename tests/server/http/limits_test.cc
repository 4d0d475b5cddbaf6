// Each limit at its value and one past it, and each clock.
#include "tests/server/http/fixture.h"

namespace tests::server_http {
namespace {

using std::chrono::milliseconds;
using LimitsTest = HttpTest;

TEST_F(LimitsTest, ABodyAtTheLimitIsTakenAndOnePastIsNot) {
  options_.memory_body_limit = 1000;
  options_.file_body_limit = 2000;
  start();
  const std::string kChunked = "Transfer-Encoding: chunked\r\n";
  for (const auto& [path, limit] : {std::pair<std::string, std::size_t>{"/echo", 1000}, {"/upload", 2000}}) {
    const std::string fits(limit, 'a');
    EXPECT_EQ(ask("POST " + path, "Content-Length: " + std::to_string(limit) + "\r\n", fits).body, fits);
    EXPECT_EQ(ask("POST " + path, kChunked, chunk(fits.substr(1)) + chunk("b") + "0\r\n\r\n").body,
              fits.substr(1) + "b");
    const RawAnswer declared = ask("POST " + path, "Content-Length: " + std::to_string(limit + 1) + "\r\n");
    EXPECT_EQ(declared.status, 413);
    EXPECT_EQ(declared.header("connection"), "close");
    const RawAnswer grown = ask("POST " + path, kChunked, chunk(fits) + chunk("b") + "0\r\n\r\n");
    EXPECT_EQ(grown.status, 413);
    EXPECT_EQ(grown.header("connection"), "close");
  }
  EXPECT_TRUE(std::filesystem::is_empty(options_.upload_dir));
}

TEST_F(LimitsTest, ARouteMayHaveItsOwnLimit) {
  router_.add({.method = Method::kPost,
               .pattern = "/small",
               .query = {},
               .body = BodyKind::kMemory,
               .body_limit = 3,
               .handler = [](Request& r) { return text(r.body); }});
  start();
  EXPECT_EQ(ask("POST /small", "Content-Length: 3\r\n", "abc").body, "abc");
  EXPECT_EQ(ask("POST /small", "Content-Length: 4\r\n", "abcd").status, 413);
}

TEST_F(LimitsTest, AClientInMidUploadSeesTheRefusal) {
  options_.memory_body_limit = 1000;
  start();
  RawClient client(port_);
  EXPECT_TRUE(client.send("POST /echo HTTP/1.1\r\nHost: t\r\nContent-Length: 6000000\r\n\r\n"));
  EXPECT_TRUE(client.send(std::string(6'000'000, 'x')));
  const RawAnswer answer = client.read_answer();
  EXPECT_EQ(answer.status, 413);
  EXPECT_TRUE(answer.complete);
}

TEST_F(LimitsTest, AnExpectationIsAnsweredBeforeTheBody) {
  options_.memory_body_limit = 10;
  start();
  RawClient client(port_);
  const std::string head = "POST /echo HTTP/1.1\r\nHost: t\r\nExpect: 100-continue\r\nContent-Length: ";
  EXPECT_EQ(client.ask(head + "5\r\n\r\n").status, 100);
  EXPECT_EQ(client.ask("hello").body, "hello");
  EXPECT_EQ(client.ask(head + "11\r\n\r\n").status, 413);
  EXPECT_EQ(RawClient(port_)
                .ask("POST /nowhere HTTP/1.1\r\nHost: t\r\nExpect: 100-continue\r\nContent-Length: 5\r\n\r\n")
                .status,
            404);
}

TEST_F(LimitsTest, AHeadAtTheLimitIsTakenAndOnePastIsNot) {
  options_.header_bytes = 1000;
  start();
  const std::string begin = "GET /hello HTTP/1.1\r\nHost: t\r\nX: ";
  const std::string fits = begin + std::string(1000 - begin.size() - 4, 'x') + "\r\n\r\n";
  ASSERT_EQ(fits.size(), 1000U);
  RawClient client(port_);
  EXPECT_EQ(client.ask(fits).status, 200);
  EXPECT_EQ(client.ask(begin + "x" + fits.substr(begin.size())).status, 431);
  EXPECT_TRUE(client.closed());
  EXPECT_EQ(RawClient(port_).ask("GET /" + std::string(2000, 'y')).status, 414);
  EXPECT_EQ(RawClient(port_).ask("GET / HTTP/1.1\r\nX: " + std::string(2000, 'y')).status, 431);
}

TEST_F(LimitsTest, FieldsAreCounted) {
  options_.header_fields = 5;
  start();
  EXPECT_EQ(ask("GET /hello", "A: 1\r\nB: 1\r\nC: 1\r\nD: 1\r\n").status, 200);
  EXPECT_EQ(ask("GET /hello", "A: 1\r\nB: 1\r\nC: 1\r\nD: 1\r\nE: 1\r\n").status, 431);
}

TEST_F(LimitsTest, ASlowHeadIsAnsweredWith408) {
  options_.header_timeout = milliseconds(250);
  start();
  RawClient slow(port_);
  slow.send("GET /hello HTTP/1.1\r\n");
  std::thread dripping([&] {
    for (int i = 0; i < 8; ++i) {
      slow.send("X: y\r\n");
      std::this_thread::sleep_for(milliseconds(50));
    }
  });
  const RawAnswer answer = slow.read_answer();
  dripping.join();
  EXPECT_EQ(answer.status, 408);
  RawClient silent(port_);
  EXPECT_TRUE(silent.closed());
}

TEST_F(LimitsTest, AnIdleConnectionIsClosed) {
  options_.keep_alive_timeout = milliseconds(150);
  start();
  RawClient client(port_);
  EXPECT_EQ(client.ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").status, 200);
  EXPECT_TRUE(client.closed());
}

TEST_F(LimitsTest, ASlowBodyIsAnsweredWith408) {
  options_.header_timeout = milliseconds(200);
  options_.min_bytes_per_second = 100;
  start();
  RawClient slow(port_);
  slow.send("POST /echo HTTP/1.1\r\nHost: t\r\nContent-Length: 1000\r\n\r\n");
  std::thread dripping([&] {
    for (int i = 0; i < 10 && slow.send("y"); ++i) std::this_thread::sleep_for(milliseconds(60));
  });
  EXPECT_EQ(slow.read_answer().status, 408);
  dripping.join();

  RawClient steady(port_);
  steady.send("POST /echo HTTP/1.1\r\nHost: t\r\nContent-Length: 400\r\n\r\n");
  for (int i = 0; i < 10; ++i) {
    steady.send(std::string(40, 'z'));
    std::this_thread::sleep_for(milliseconds(60));
  }
  EXPECT_EQ(steady.read_answer().status, 200);
}

TEST_F(LimitsTest, AConnectionServesOnlySoManyRequests) {
  options_.requests_per_connection = 2;
  start();
  RawClient client(port_);
  EXPECT_EQ(client.ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").header("connection"), "");
  EXPECT_EQ(client.ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").header("connection"), "close");
  EXPECT_TRUE(client.closed());
}

TEST_F(LimitsTest, TooManyConnectionsAreToldSo) {
  options_.max_connections_per_address = 2;
  start();
  const std::string request = "GET /hello HTTP/1.1\r\nHost: t\r\n\r\n";
  RawClient first(port_);
  EXPECT_EQ(first.ask(request).status, 200);
  {
    RawClient second(port_);
    EXPECT_EQ(second.ask(request).status, 200);
    const RawAnswer refused = RawClient(port_).ask(request);
    EXPECT_EQ(refused.status, 503);
    EXPECT_NE(refused.header("retry-after"), "");
    EXPECT_EQ(refused.header("access-control-allow-origin"), "*");
  }
  int status = 503;
  for (int i = 0; i < 100 && status == 503; ++i) {
    std::this_thread::sleep_for(milliseconds(20));
    status = RawClient(port_).ask(request).status;
  }
  EXPECT_EQ(status, 200);
  EXPECT_EQ(first.ask(request).status, 200);
}

TEST_F(LimitsTest, TheCapInAllHoldsToo) {
  options_.max_connections = 1;
  start();
  RawClient first(port_);
  EXPECT_EQ(first.ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").status, 200);
  EXPECT_EQ(RawClient(port_).read_answer().status, 503);
}

TEST_F(LimitsTest, AClientThatStopsReadingIsCut) {
  options_.stall_timeout = milliseconds(300);
  add(Method::kGet, "/endless", [](Request&) {
    return streaming([](int, std::string& piece) {
      piece.assign(100'000, 'e');
      return true;
    });
  });
  start();
  RawClient client(port_, 4096);
  client.send("GET /endless HTTP/1.1\r\nHost: t\r\n\r\n");
  for (int i = 0; i < 200 && accesses().empty(); ++i) std::this_thread::sleep_for(milliseconds(20));
  ASSERT_EQ(accesses().size(), 1U);
  EXPECT_TRUE(accesses()[0].cut);
}

TEST_F(LimitsTest, AnUploadThatCannotBeStoredIsAnError) {
  start();
  std::filesystem::remove_all(options_.upload_dir);
  EXPECT_EQ(ask("POST /upload", "Content-Length: 3\r\n", "abc").status, 507);
  EXPECT_EQ(problems().size(), 1U);
}

constexpr std::size_t kBig = 100'000;

std::string post_big(std::size_t size = kBig) {
  return "POST /echo HTTP/1.1\r\nHost: t\r\nContent-Length: " + std::to_string(size) + "\r\n\r\n";
}

TEST_F(LimitsTest, BodiesInMemoryShareWhatTheyMayTake) {
  options_.buffered_bytes = 4 * kBig;
  start();
  RawClient holder(port_);
  holder.send(post_big(4 * kBig));
  holder.send(std::string(3 * kBig, 'x'));
  std::this_thread::sleep_for(milliseconds(100));
  RawClient other(port_);
  other.send(post_big(3 * kBig) + std::string(3 * kBig, 'y'));
  const RawAnswer refused = other.read_answer();
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(RawClient(port_).ask(post_big(5) + "hello").body, "hello") << "what is small always goes";
  holder.send(std::string(kBig, 'x'));
  EXPECT_EQ(holder.read_answer().body.size(), 4 * kBig) << "at the limit";
  int status = 0;  // the server lets go a moment after the client has its answer
  for (int i = 0; i < 100 && status != 200; ++i) {
    status = RawClient(port_).ask(post_big(3 * kBig) + std::string(3 * kBig, 'y')).status;
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_EQ(status, 200);
  EXPECT_EQ(RawClient(port_).ask(post_big(5 * kBig) + std::string(5 * kBig, 'y')).status, 503) << "past it";
}

/// It has been done: to say that it was refused would be wrong.
TEST_F(LimitsTest, WhatChangedSomethingIsAnsweredWithOrWithoutRoom) {
  options_.buffered_bytes = kBig;
  add(Method::kPost, "/change", [](Request&) { return text(std::string(2 * kBig, 'c')); });
  start();
  EXPECT_EQ(ask("POST /change", "Content-Length: 0\r\n").body.size(), 2 * kBig);
  EXPECT_EQ(RawClient(port_).ask(post_big(1000) + std::string(1000, 'y')).status, 200);
}

TEST_F(LimitsTest, AnswersThatWaitForSlowClientsShareItToo) {
  constexpr std::size_t kAnswer = 8'000'000;  // more than sockets hold
  options_.buffered_bytes = 2 * kAnswer;
  options_.compress_from_bytes = 0;
  add(Method::kGet, "/big", [](Request&) { return text(std::string(kAnswer, 'b')); });
  start();
  const std::string request = "GET /big HTTP/1.1\r\nHost: t\r\n\r\n";
  RawClient first(port_, 4096), second(port_, 4096);
  for (RawClient* client : {&first, &second}) {
    client->send(request);
    EXPECT_NE(client->read_some().find(" 200 "), std::string::npos);
  }
  EXPECT_EQ(RawClient(port_).ask(request).status, 503);
  EXPECT_EQ(RawClient(port_).ask("GET /hello HTTP/1.1\r\nHost: t\r\n\r\n").status, 200);
  while (first.read_some().size() > 0 && accesses().size() < 3) {
  }
  int status = 0;
  for (int i = 0; i < 100 && status != 200; ++i) {
    status = RawClient(port_).ask(request).status;
    std::this_thread::sleep_for(milliseconds(20));
  }
  EXPECT_EQ(status, 200) << "the first has all of its answer";
}

}  // namespace
}  // namespace tests::server_http
