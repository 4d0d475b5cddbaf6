#include "server/auth/tokens.h"

#include <gtest/gtest.h>

#include <set>

namespace server::auth {
namespace {

TEST(TokensTest, EachTokenIsNewAndFitsAField) {
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) {
    const std::string token = make_token();
    EXPECT_TRUE(seen.insert(token).second);
    EXPECT_EQ(token.size(), 9U + 43U);
    EXPECT_EQ(token.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
              std::string::npos);
  }
}

TEST(TokensTest, HashesAreSha256) {
  // FIPS 180-2, appendix B.1.
  EXPECT_EQ(hash_token("abc"), "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_TRUE(is_hash(hash_token("")));
  for (const char* text :
       {"", "sha256:", "abc", "sha256:BA7816BF8F01CFEA414140DE5DAE2223B00361A396177A9CB410FF61F20015AD",
        "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015a",
        "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015adc",
        "sha256:xa7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"}) {
    EXPECT_FALSE(is_hash(text)) << text;
  }
}

TEST(TokensTest, OnlyTheTokenItselfIsFound) {
  const std::string a = make_token(), b = make_token();
  const Tokens tokens({{"a", hash_token(a), true, false}, {"b", hash_token(b), true, true}});
  ASSERT_NE(tokens.find(a), nullptr);
  EXPECT_EQ(tokens.find(a)->name, "a");
  EXPECT_FALSE(tokens.find(a)->write);
  EXPECT_EQ(tokens.find(b)->name, "b");
  EXPECT_EQ(tokens.find(""), nullptr);
  EXPECT_EQ(tokens.find(a.substr(1)), nullptr);
  EXPECT_EQ(tokens.find(a + "x"), nullptr);
  EXPECT_EQ(tokens.find(hash_token(a)), nullptr) << "a hash that was stolen is no token";
  EXPECT_EQ(Tokens({}).find(a), nullptr);
}

TEST(TokensTest, TheFieldIsReadStrictly) {
  EXPECT_EQ(bearer_token("Bearer abc"), "abc");
  EXPECT_EQ(bearer_token("bEARER   abc"), "abc");
  for (const char* field :
       {"", "Bearer", "Bearer ", "Bearer    ", "Basic abc", "Bearerabc", "Bearer a b", "abc"}) {
    EXPECT_EQ(bearer_token(field), std::nullopt) << field;
  }
}

}  // namespace
}  // namespace server::auth
