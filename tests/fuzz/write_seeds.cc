// In a real fuzzer: TINSMITH_WRITE_SEEDS=FOLDER writes the target's seeds there, as its first corpus, and
// ends.
#include <cstdlib>
#include <fstream>

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* folder = std::getenv("TINSMITH_WRITE_SEEDS");
  if (folder == nullptr) return 0;
  int number = 0;
  for (const std::string& seed : tests::fuzz::seeds()) {
    std::ofstream(std::string(folder) + "/seed-" + std::to_string(number++), std::ios::binary) << seed;
  }
  std::exit(0);
}
