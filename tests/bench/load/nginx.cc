#include "tests/bench/load/nginx.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/http_client.h"

namespace tests::load {
namespace {

/// A port that was free a moment ago.
std::uint16_t free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(socket);
  return ntohs(address.sin_port);
}

}  // namespace

std::unique_ptr<Nginx> Nginx::start() {
  const char* program = "/usr/sbin/nginx";
  if (!std::filesystem::exists(program)) return nullptr;
  std::unique_ptr<Nginx> made(new Nginx);
  made->port_ = free_port();
  const std::string folder = made->folder_.path();
  std::ofstream(folder + "/nginx.conf")
      << "daemon off; master_process off; worker_processes 1; pid " << folder << "/pid; error_log " << folder
      << "/log; events { worker_connections 1024; } http { access_log off; client_body_temp_path " << folder
      << "; proxy_temp_path " << folder << "/p; fastcgi_temp_path " << folder << "/f; uwsgi_temp_path "
      << folder << "/u; scgi_temp_path " << folder
      << "/s; keepalive_requests 1000000000; server { listen 127.0.0.1:" << made->port_
      << "; location / { default_type application/json; return 200 "
      << R"('{"z":123.456,"triangle":[1,2,3],"revision":1}'; } } })";
  made->child_ = std::make_unique<support::Child>(
      std::vector<std::string>{program, "-c", folder + "/nginx.conf", "-p", folder}, folder + "/err");
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    try {
      if (support::HttpClient(made->port_).get("/").status == 200) return made;
    } catch (const std::exception&) {
    }
  }
  return nullptr;
}

Nginx::~Nginx() {
  if (!child_) return;
  child_->signal(SIGTERM);
  child_->wait();
}

}  // namespace tests::load
