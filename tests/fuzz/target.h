// What a fuzz target is: a function that takes any bytes and must neither crash, hang nor break a promise,
// and seeds from which mutations begin.
//
//   std::vector<std::string> tests::fuzz::seeds() { return {R"({"a":1})"}; }
//   extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
//     const std::string_view bytes = tests::fuzz::text(data, size);
//     TIN_CHECK(decode(encode(bytes)) == bytes);
//     return 0;
//   }
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The name is libFuzzer's. Returns 0. A broken promise aborts (TIN_CHECK).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace tests::fuzz {

/// Inputs that reach deep, made by code; each target defines it.
std::vector<std::string> seeds();

inline std::string_view text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace tests::fuzz
