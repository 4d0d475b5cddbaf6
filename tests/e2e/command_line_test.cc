// What the program says of itself, and how it refuses.
#include <csignal>
#include <fstream>
#include <thread>

#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

using support::Finished;
using support::run;

Finished tinsmith(std::vector<std::string> words) {
  words.insert(words.begin(), TINSMITH_PROGRAM);
  return run(words);
}

class CommandLineTest : public ServedTest {
 protected:
  std::string config(const std::string& text) {
    const std::string file = folder_.path() / "config.json";
    std::ofstream(file) << text;
    return file;
  }
};

TEST_F(CommandLineTest, TheVersionIsTheOneThatHealthTells) {
  const Finished said = tinsmith({"--version"});
  EXPECT_EQ(said.status, 0);
  start();
  EXPECT_EQ(said.out, "tinsmith " + served_->get("/healthz").at("version").get<std::string>() + "\n");
}

TEST_F(CommandLineTest, HelpNamesTheCommandAndItsOptions) {
  const Finished all = tinsmith({"--help"}), serve = tinsmith({"serve", "--help"});
  EXPECT_EQ(all.status, 0);
  EXPECT_NE(all.out.find("serve"), std::string::npos);
  EXPECT_EQ(serve.status, 0);
  for (const char* option : {"--listen", "--data", "--config"})
    EXPECT_NE(serve.out.find(option), std::string::npos) << option;
}

TEST_F(CommandLineTest, WrongUsageEndsWithTwoAndSaysWhatIsWrong) {
  for (const auto& words : std::vector<std::vector<std::string>>{
           {}, {"fly"}, {"serve", "--speed", "9"}, {"serve", "--listen"}, {"serve", "extra"}}) {
    const Finished said = tinsmith(words);
    EXPECT_EQ(said.status, 2);
    EXPECT_EQ(said.out, "");
    EXPECT_NE(said.err, "");
  }
}

TEST_F(CommandLineTest, WhatCannotBeServedEndsWithOneAndASentence) {
  const auto expect = [&](const std::vector<std::string>& more, const std::string& word) {
    std::vector<std::string> words{"serve"};
    words.insert(words.end(), more.begin(), more.end());
    if (more.front() != "--data") words.insert(words.end(), {"--data", data().string()});
    const Finished said = tinsmith(words);
    EXPECT_EQ(said.status, 1) << word;
    EXPECT_EQ(said.out, "");
    EXPECT_TRUE(said.err.starts_with("tinsmith: ")) << said.err;
    EXPECT_NE(said.err.find(word), std::string::npos) << said.err;
  };
  expect({"--listen", "nowhere"}, "an address and a port");
  expect({"--listen", "127.0.0.1:99999"}, "an address and a port");
  expect({"--config", "/nowhere/config.json"}, "/nowhere/config.json");
  expect({"--config", config("{")}, "config.json");
  expect({"--config", config(R"({"limits":{"tin":1}})")}, "/limits/tin");
  expect({"--config", config(R"({"limits":{"tins":"many"}})")}, "/limits/tins");
  expect({"--data", config("a file")}, "folder");
}

TEST_F(CommandLineTest, OthersAreServedOnlyWithTokensOrWhenThatIsMeant) {
  const std::vector<std::string> open{"serve", "--data", data().string(), "--listen", "0.0.0.0:0"};
  const Finished refused = tinsmith(open);
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("--insecure"), std::string::npos) << refused.err;
  const std::string hash = "sha256:" + std::string(64, 'a');
  const std::string tokens =
      config(R"({"auth":{"tokens":[{"name":"a","hash":")" + hash + R"(","scopes":["read"]}]}})");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--insecure"}, {"--config", tokens}}) {
    std::vector<std::string> words = open;
    words.insert(words.begin(), TINSMITH_PROGRAM);
    words.insert(words.end(), more.begin(), more.end());
    support::Child child(words, folder_.path() / "log");
    EXPECT_NE(child.read_line().find("http://0.0.0.0:"), std::string::npos) << more[0];
    child.signal(SIGTERM);
    EXPECT_EQ(child.wait(), 0);
  }
}

TEST_F(CommandLineTest, ATokenWorksAsTheConfigurationIsTold) {
  const Finished made = tinsmith({"token", "--name", "a \"survey\"", "--write"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::size_t begin = made.out.find("tinsmith_"), entry = made.out.find("  {");
  ASSERT_NE(begin, std::string::npos);
  ASSERT_NE(entry, std::string::npos);
  const std::string token = made.out.substr(begin, made.out.find('\n', begin) - begin);
  start({"--config", config(R"({"auth":{"tokens":[)" + made.out.substr(entry) + "]}}")});
  EXPECT_EQ(served_->http().get("/tins").status, 401);
  EXPECT_EQ(served_->http().get("/tins", "Authorization: Bearer " + token + "\r\n").status, 200);
  EXPECT_EQ(tinsmith({"token"}).status, 2);
}

TEST_F(CommandLineTest, ReadinessEndsBeforeTheServerDoes) {
  start({"--config", config(R"({"http":{"drain_notice_seconds":4}})")});
  EXPECT_EQ(served_->http().get("/readyz").status, 200);
  std::jthread stopping([&] { EXPECT_EQ(served_->stop(), 0); });
  while (served_->http().get("/readyz").status == 200) std::this_thread::yield();
  EXPECT_EQ(served_->http().get("/readyz").status, 503);
  EXPECT_EQ(served_->http().get("/tins").status, 200) << "what arrives meanwhile is served";
}

TEST_F(CommandLineTest, APortThatIsTakenIsSaid) {
  start();
  const Finished said = tinsmith({"serve", "--data", (folder_.path() / "other").string(), "--listen",
                                  "127.0.0.1:" + std::to_string(served_->http().port())});
  EXPECT_EQ(said.status, 1);
  EXPECT_NE(said.err.find(std::to_string(served_->http().port())), std::string::npos) << said.err;
}

TEST_F(CommandLineTest, TheConfigurationSetsLimitsAndTheCommandLineGoesFirst) {
  start({"--config", config(R"({"listen":"127.0.0.1:1","limits":{"tins":1}})")});
  EXPECT_EQ(served_->http().post_json("/tins", "{}").status, 201);
  EXPECT_EQ(served_->http().post_json("/tins", "{}").status, 429);
}

}  // namespace
}  // namespace tests::e2e
