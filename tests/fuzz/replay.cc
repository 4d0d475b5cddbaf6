// A fuzz target as a test: its seeds and mutations of them, or files.
//
//   fuzz_json                     the seeds, then TINSMITH_FUZZ_ROUNDS (20,000) mutations from TINSMITH_SEED
//   fuzz_json FILE-OR-FOLDER...   these inputs: a finding of a real fuzzer, or its whole corpus
//
// An input that crashes or takes longer than kMostSeconds is written to NAME-finding in the working folder.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/target.h"

namespace {

constexpr unsigned kMostSeconds = 20;

std::string present;       // the input being tried
std::string finding_file;  // where it goes if it is the last

extern "C" void keep_finding(int number) {
  std::signal(number, SIG_DFL);
  const int file = ::open(finding_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const bool kept = file >= 0 && ::write(file, present.data(), present.size()) >= 0;
  const char* say = kept ? "the input is kept in a file: " : "the input could not be kept: ";
  for (const char* text : {say, finding_file.c_str(), "\n"}) {
    if (::write(2, text, std::char_traits<char>::length(text)) < 0) break;
  }
  std::raise(number);
}

void attempt(std::string input) {
  present = std::move(input);
  ::alarm(kMostSeconds);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(present.data()), present.size());
  ::alarm(0);
}

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int replay(int count, char** names) {
  std::size_t tried = 0;
  for (int i = 0; i < count; ++i) {
    if (!std::filesystem::is_directory(names[i])) {
      attempt(content(names[i]));
      ++tried;
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(names[i])) {
      attempt(content(entry.path()));
      ++tried;
    }
  }
  std::cout << tried << " inputs\n";
  return 0;
}

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* given = std::getenv(name);
  return given == nullptr ? otherwise : std::strtoull(given, nullptr, 10);
}

}  // namespace

int main(int argc, char** argv) {
  finding_file = std::filesystem::path(argv[0]).filename().string() + "-finding";
  for (const int number : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGILL, SIGALRM})
    std::signal(number, keep_finding);
  if (argc > 1) return replay(argc - 1, argv + 1);
  const std::vector<std::string> seeds = tests::fuzz::seeds();
  const std::uint64_t seed = from_environment("TINSMITH_SEED", std::random_device{}());
  const std::uint64_t rounds = from_environment("TINSMITH_FUZZ_ROUNDS", 20'000);
  std::cout << "TINSMITH_SEED=" << seed << std::endl;
  std::mt19937_64 random(seed);
  attempt("");
  for (const std::string& input : seeds) attempt(input);
  for (std::uint64_t i = 0; i < rounds; ++i) {
    attempt(tests::fuzz::mutate(seeds[random() % seeds.size()], seeds, random));
  }
  std::cout << seeds.size() << " seeds and " << rounds << " mutations\n";
  return 0;
}
