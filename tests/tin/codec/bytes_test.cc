#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/tin/codec/random_values.h"
#include "tests/tin/codec/resummed.h"
#include "tin/codec/bytes_internal.h"
#include "tin/codec/crc32c.h"

namespace tin::codec {
namespace {

constexpr std::size_t kEnvelope = 4 + 2;

Reader read(std::string_view bytes) {
  return Reader(bytes, "TEST", 1, "test");
}

std::string closed(std::string_view payload) {
  std::string bytes("TEST\x01\x00", kEnvelope);
  bytes += payload;
  return testing::resummed(bytes + "....");
}

TEST(Crc32cTest, KnownAnswers) {
  EXPECT_EQ(crc32c(""), 0u);
  EXPECT_EQ(crc32c("123456789"), 0xe3069283u);
  EXPECT_EQ(crc32c(std::string(32, '\0')), 0x8a9136aau);  // RFC 3720, B.4
  EXPECT_EQ(crc32c(std::string(32, '\xff')), 0x62a8ab43u);
}

TEST(Crc32cTest, SumsInParts) {
  testing::Random random(testing::seed());
  for (int round = 0; round < 200; ++round) {
    const std::string a = testing::any_text(random);
    const std::string b = testing::any_text(random);
    EXPECT_EQ(crc32c(b, crc32c(a)), crc32c(a + b));
  }
}

TEST(BytesTest, IntegersOfAllSizesRoundTrip) {
  Writer out("TEST", 1);
  std::vector<std::uint64_t> values{0, std::numeric_limits<std::uint64_t>::max()};
  for (int bit = 0; bit < 64; ++bit) {
    for (std::uint64_t offset : {0, 1, 2}) values.push_back((std::uint64_t{1} << bit) - 1 + offset);
  }
  for (const std::uint64_t value : values) {
    out.varint(value);
    out.zigzag(static_cast<std::int64_t>(value));
  }
  const std::string bytes = out.finish();
  Reader in = read(bytes);
  for (const std::uint64_t value : values) {
    EXPECT_EQ(in.varint(), value);
    EXPECT_EQ(in.zigzag(), static_cast<std::int64_t>(value));
  }
  in.finish();
  EXPECT_TRUE(in.ok());
}

TEST(BytesTest, NumbersHaveOneSpelling) {
  for (const std::string_view payload :
       {std::string_view("\x80\x00", 2), std::string_view("\xff\xff\x00", 3),
        std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff\xff\x02"),
        std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"), std::string_view("\x80")}) {
    const std::string bytes = closed(payload);
    Reader in = read(bytes);
    ASSERT_TRUE(in.ok());
    in.varint();
    EXPECT_FALSE(in.ok());
  }
}

TEST(BytesTest, CountsAreBoundedByWhatFollows) {
  const std::string fits = closed(
      "\x03"
      "abcdef");
  Reader in = read(fits);
  EXPECT_EQ(in.count(2), 3u);
  EXPECT_TRUE(in.ok());
  const std::string one_more = closed(
      "\x04"
      "abcdef");
  Reader over = read(one_more);
  EXPECT_EQ(over.count(2), 0u);
  EXPECT_FALSE(over.ok());
}

TEST(BytesTest, NewerVersionsAreRefusedByName) {
  const std::string bytes("TEST\x02\x00 of another kind", 20);
  Reader in = read(bytes);
  ASSERT_FALSE(in.ok());
  EXPECT_EQ(in.error().code, base::Code::kUnsupported);
  EXPECT_NE(in.error().message.find("version 2"), std::string::npos) << in.error().message;
}

TEST(BytesTest, FailuresStick) {
  const std::string bytes = closed("");
  Reader in = read(bytes);
  EXPECT_EQ(in.u8(), 0);
  ASSERT_FALSE(in.ok());
  const std::string first = in.error().message;
  EXPECT_EQ(in.f64(), 0);
  EXPECT_EQ(in.text(), "");
  EXPECT_EQ(in.placement(), terrain::Placement{});
  in.require(false, "something else");
  EXPECT_EQ(in.error().message, first);
}

}  // namespace
}  // namespace tin::codec
