// Tables of bodies that a reader refuses.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>

#include "tin/base/result.h"

namespace tests_support {

struct Wrong {
  const char* body;
  tin::base::Code code;
  const char* where;  // JSON pointer, or the like
};

/// `read`, which takes a body and gives a Result, refuses each of `cases`: with its code, at its place, and
/// with a sentence.
template <class Read>
void expect_errors(std::initializer_list<Wrong> cases, Read read) {
  for (const Wrong& wrong : cases) {
    const auto result = read(wrong.body);
    ASSERT_FALSE(result.ok()) << wrong.body;
    EXPECT_EQ(static_cast<int>(result.error().code), static_cast<int>(wrong.code))
        << wrong.body << ": " << result.error().message;
    EXPECT_EQ(result.error().where, wrong.where) << wrong.body;
    EXPECT_FALSE(result.error().message.empty());
  }
}

}  // namespace tests_support
