// Starting, streaming beside others, draining and stopping.
#include <future>

#include "tests/server/http/fixture.h"

namespace tests::server_http {
namespace {

using std::chrono::milliseconds;
using tin::base::Code;
using LifecycleTest = HttpTest;

const std::string kHello = "GET /hello HTTP/1.1\r\nHost: t\r\n\r\n";

TEST_F(LifecycleTest, APortThatIsTakenIsAClearError) {
  options_.port = start();
  Server second(options_, router_, pages(), observer());
  const auto port = second.start();
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Code::kConflict);
  EXPECT_NE(port.error().message.find(std::to_string(options_.port)), std::string::npos);
}

TEST_F(LifecycleTest, BadOptionsAreClearErrors) {
  const auto code = [&](auto change) {
    ServerOptions options = options_;
    change(options);
    Server server(options, router_, pages(), observer());
    const auto port = server.start();
    return port ? Code::kInternal : port.error().code;
  };
  EXPECT_EQ(code([](ServerOptions& o) { o.address = "localhost"; }), Code::kInvalidValue);
  EXPECT_EQ(code([](ServerOptions& o) { o.address = "192.0.2.1"; }), Code::kInvalidValue);
  EXPECT_EQ(code([](ServerOptions& o) { o.io_threads = 0; }), Code::kInvalidValue);
  EXPECT_EQ(code([](ServerOptions& o) { o.worker_threads = -1; }), Code::kInvalidValue);
  EXPECT_EQ(code([](ServerOptions& o) { o.upload_dir = "/dev/null/x"; }), Code::kStorage);
}

TEST_F(LifecycleTest, ASlowReaderHoldsUpNobody) {
  constexpr int kPieces = 200;
  add(Method::kGet, "/big", [](Request&) {
    return streaming([](int i, std::string& piece) {
      piece.assign(100'000, static_cast<char>('a' + i % 26));
      return i < kPieces;
    });
  });
  options_.worker_threads = 1;
  options_.io_threads = 1;
  start();
  RawClient slow(port_, 4096);
  slow.send("GET /big HTTP/1.1\r\nHost: t\r\n\r\n");
  std::this_thread::sleep_for(milliseconds(100));
  RawClient other(port_);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(other.ask(kHello).body, "hello");
  const RawAnswer answer = slow.read_answer();
  EXPECT_TRUE(answer.complete);
  ASSERT_EQ(answer.body.size(), kPieces * 100'000U);
  for (std::size_t i = 0; i < kPieces; ++i)
    ASSERT_EQ(answer.body[i * 100'000], static_cast<char>('a' + i % 26));
  EXPECT_EQ(slow.ask(kHello).body, "hello");
}

TEST_F(LifecycleTest, ASourceThatThrowsCutsTheAnswer) {
  add(Method::kGet, "/broken", [](Request&) {
    return streaming([](int i, std::string& piece) {
      if (i == 2) throw std::runtime_error("out of luck");
      piece = "part";
      return true;
    });
  });
  start();
  RawClient client(port_);
  const RawAnswer answer = client.ask("GET /broken HTTP/1.1\r\nHost: t\r\n\r\n");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "partpart");
  EXPECT_FALSE(answer.complete);
  const RawAnswer old = RawClient(port_).ask("GET /broken HTTP/1.0\r\n\r\n");
  EXPECT_FALSE(old.complete);
  ASSERT_EQ(problems().size(), 2U);
  EXPECT_NE(problems()[0].second.find("out of luck"), std::string::npos);
}

TEST_F(LifecycleTest, WaitingSourcesHoldNoThread) {
  options_.worker_threads = 1;
  options_.poll_interval = milliseconds(20);
  add(Method::kGet, "/events", [&](Request&) {
    return streaming([&](int i, std::string& piece) {
      if (i == 0 || i == 3) piece = std::to_string(i) + ";";
      return true;
    });
  });
  start();
  std::vector<std::unique_ptr<RawClient>> waiting;
  for (int i = 0; i < 10; ++i) {
    waiting.push_back(std::make_unique<RawClient>(port_));
    waiting.back()->send("GET /events HTTP/1.1\r\nHost: t\r\n\r\n");
  }
  std::this_thread::sleep_for(milliseconds(500));
  EXPECT_EQ(RawClient(port_).ask(kHello).body, "hello");
  const auto begin = std::chrono::steady_clock::now();
  server_->stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(8));
  for (const auto& client : waiting) {
    const RawAnswer answer = client->read_answer();
    EXPECT_EQ(answer.body, "0;3;");
    EXPECT_TRUE(answer.complete);
  }
}

TEST_F(LifecycleTest, StoppingFinishesWhatRunsAndClosesWhatIdles) {
  add(Method::kGet, "/slow", [&](Request&) {
    gate_.pass();
    return text("done");
  });
  start();
  RawClient idle(port_);
  EXPECT_EQ(idle.ask(kHello).status, 200);
  RawClient fresh(port_);
  RawClient busy(port_);
  busy.send("GET /slow HTTP/1.1\r\nHost: t\r\n\r\n");
  gate_.wait_for_visitor();
  auto stopping = std::async(std::launch::async, [&] { server_->stop(); });
  EXPECT_TRUE(idle.closed());
  EXPECT_TRUE(fresh.closed());
  EXPECT_EQ(stopping.wait_for(milliseconds(100)), std::future_status::timeout);
  gate_.open();
  const RawAnswer answer = busy.read_answer();
  EXPECT_EQ(answer.body, "done");
  EXPECT_EQ(answer.header("connection"), "close");
  EXPECT_TRUE(busy.closed());
  stopping.get();
  EXPECT_THROW(RawClient{port_}, std::runtime_error);
  server_->stop();
}

TEST_F(LifecycleTest, WhatOutlastsTheDrainIsCut) {
  options_.drain_timeout = milliseconds(200);
  add(Method::kGet, "/endless", [](Request&) {
    return streaming([](int, std::string& piece) {
      piece.assign(1000, 'e');
      return true;
    });
  });
  start();
  RawClient client(port_);
  client.send("GET /endless HTTP/1.1\r\nHost: t\r\n\r\n");
  RawClient half(port_);
  half.send("GET /hel");
  std::this_thread::sleep_for(milliseconds(50));
  const auto begin = std::chrono::steady_clock::now();
  server_->stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_FALSE(client.read_answer().complete);
}

TEST_F(LifecycleTest, ManyClientsAtOnce) {
  start();
  std::vector<std::thread> clients;
  std::atomic<int> right = 0;
  for (int c = 0; c < 8; ++c) {
    clients.emplace_back([&, c] {
      RawClient client(port_);
      for (int i = 0; i < 50; ++i) {
        const std::string body = std::to_string(c * 1000 + i);
        const RawAnswer answer =
            client.ask("POST /echo HTTP/1.1\r\nHost: t\r\nContent-Length: " + std::to_string(body.size()) +
                       "\r\n\r\n" + body);
        right += answer.body == body;
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(right, 400);
}

/// A handler that works until nobody waits for it, or for ten seconds at most.
Response work(Request& request, std::promise<bool>& lost) {
  tin::base::Progress progress;
  const server::http::Attention::Work work(request.attention, progress);
  for (int i = 0; i < 1000 && !progress.cancelled(); ++i) std::this_thread::sleep_for(milliseconds(10));
  lost.set_value(progress.cancelled() && request.is_aborted());
  return text("late");
}

TEST_F(LifecycleTest, WorkIsCancelledWhenItsClientGoes) {
  std::promise<bool> lost;
  add(Method::kGet, "/work", [&](Request& request) { return work(request, lost); });
  start();
  auto client = std::make_unique<RawClient>(port_);
  client->send("GET /work HTTP/1.1\r\nHost: t\r\n\r\n");
  std::this_thread::sleep_for(milliseconds(100));
  client.reset();
  EXPECT_TRUE(lost.get_future().get());
  for (int i = 0; i < 500 && accesses().empty(); ++i) std::this_thread::sleep_for(milliseconds(10));
  EXPECT_EQ(accesses().size(), 1U);
}

TEST_F(LifecycleTest, WorkIsCancelledWhenTheServerWaitsNoLonger) {
  options_.drain_timeout = milliseconds(100);
  std::promise<bool> lost;
  add(Method::kGet, "/work", [&](Request& request) { return work(request, lost); });
  start();
  RawClient client(port_);
  client.send("GET /work HTTP/1.1\r\nHost: t\r\n\r\n");
  std::this_thread::sleep_for(milliseconds(100));
  server_->stop();
  EXPECT_TRUE(lost.get_future().get());
}

TEST_F(LifecycleTest, AClientThatOnlyEndsItsSendingGetsItsAnswer) {
  add(Method::kGet, "/slow", [&](Request& request) {
    std::this_thread::sleep_for(milliseconds(700));
    return text(request.is_aborted() ? "lost" : "done");
  });
  start();
  RawClient client(port_);
  client.send("GET /slow HTTP/1.1\r\nHost: t\r\n\r\n");
  client.finish_sending();
  EXPECT_EQ(client.read_answer().status, 102);
  EXPECT_EQ(client.read_answer().body, "done");
  RawClient quick(port_);
  quick.send(kHello);
  quick.finish_sending();
  EXPECT_EQ(quick.read_answer().body, "hello");
}

TEST_F(LifecycleTest, ARequestThatFollowsIsNoEnd) {
  add(Method::kGet, "/slow", [&](Request& request) {
    gate_.pass();
    return text(request.is_aborted() ? "lost" : "done");
  });
  start();
  RawClient client(port_);
  client.send("GET /slow HTTP/1.1\r\nHost: t\r\n\r\n");
  gate_.wait_for_visitor();
  client.send(kHello);
  std::this_thread::sleep_for(milliseconds(50));
  gate_.open();
  EXPECT_EQ(client.read_answer().body, "done");
  EXPECT_EQ(client.read_answer().body, "hello");
}

}  // namespace
}  // namespace tests::server_http
