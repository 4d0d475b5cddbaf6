#include "tests/e2e/served.h"

#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

namespace tests::e2e {

Served::Served(const std::filesystem::path& data, const std::vector<std::string>& more)
    : err_file_(data.parent_path() / "server.log") {
  std::vector<std::string> words{TINSMITH_PROGRAM, "serve",  "--listen",
                                 "127.0.0.1:0",    "--data", data.string()};
  words.insert(words.end(), more.begin(), more.end());
  child_ = std::make_unique<support::Child>(words, err_file_);
  line_ = child_->read_line();
  const std::size_t colon = line_.rfind(':');
  if (line_.find("http://127.0.0.1:") == std::string::npos) {
    std::ostringstream log;
    log << std::ifstream(err_file_).rdbuf();
    throw std::runtime_error("the server did not say where it listens: " + line_ + "\n" + log.str());
  }
  port_ = static_cast<std::uint16_t>(std::stoi(line_.substr(colon + 1)));
}

int Served::stop() {
  child_->signal(SIGTERM);
  return child_->wait();
}

void Served::kill() {
  child_->signal(SIGKILL);
  child_->wait();
}

RawAnswer Served::upload(const std::string& query, const std::filesystem::path& file,
                         const std::string& fields) const {
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  const std::string name =
      "Content-Disposition: attachment; filename=\"" + file.filename().string() + "\"\r\n";
  return http().post("/tins" + query, "application/octet-stream", bytes.str(), name + fields);
}

Json Served::get(const std::string& target) const {
  const RawAnswer answer = http().get(target);
  EXPECT_EQ(answer.status, 200) << target << "\n" << answer.body.substr(0, 500);
  EXPECT_TRUE(answer.complete) << target;
  return Json::parse(answer.body, nullptr, false);
}

Json Served::edit(const std::string& tin, const Json& ops) const {
  const RawAnswer answer = http().post_json("/tins/" + tin + "/edits", Json{{"ops", ops}}.dump());
  EXPECT_EQ(answer.status, 200) << answer.body.substr(0, 500);
  return Json::parse(answer.body, nullptr, false);
}

Json Served::simplify(const Json& inputs) const {
  const RawAnswer answer = http().post_json("/processes/simplify/execution", Json{{"inputs", inputs}}.dump());
  EXPECT_EQ(answer.status, 200) << answer.body.substr(0, 500);
  return Json::parse(answer.body, nullptr, false);
}

Json Served::finished_job(const std::string& job) const {
  for (;;) {
    Json status = get(job);
    if (!status.is_object() || (status.at("status") != "accepted" && status.at("status") != "running"))
      return status;
    std::this_thread::yield();
  }
}

std::string ServedTest::save(const RawAnswer& answer, const std::string& name) const {
  EXPECT_EQ(answer.status, 200) << name << "\n" << answer.body.substr(0, 500);
  EXPECT_TRUE(answer.complete) << name;
  const std::string file = folder_.path() / name;
  std::ofstream(file, std::ios::binary) << answer.body;
  return file;
}

}  // namespace tests::e2e
