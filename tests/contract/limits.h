// What the tests of limits ask for, and how a limit answers.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/contract/test_server.h"

namespace tests::contract {

/// `count` vertices on a parabola, from the `first` on.
inline std::string vertices(int count, int first = 0) {
  std::string list;
  for (int i = first; i < first + count; ++i) {
    list += (i == first ? "[" : ",[") + std::to_string(i) + "," + std::to_string(i * i) + "," +
            std::to_string(i) + "]";
  }
  return "[" + list + "]";
}

inline std::string inserts(int count, int first) {
  std::string list;
  for (int i = first; i < first + count; ++i) {
    list += (i == first ? "" : ",") + (R"({"op":"insert","x":)" + std::to_string(i) + R"(,"y":)") +
            std::to_string(i * i) + R"(,"z":1})";
  }
  return R"({"ops":[)" + list + "]}";
}

inline void expect_too_large(const RawAnswer& answer) {
  EXPECT_EQ(answer.status, 413) << answer.body.substr(0, 300);
  EXPECT_EQ(slug(answer), "too-large");
}

}  // namespace tests::contract
