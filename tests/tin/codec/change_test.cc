#include "tin/codec/change.h"

#include <gtest/gtest.h>

#include "tests/tin/codec/random_values.h"
#include "tests/tin/codec/resummed.h"

namespace tin::codec {
namespace {

using terrain::Change;
using terrain::Placement;
using terrain::Step;
using terrain::VertexId;
using testing::Random;

Change any_change(Random& random) {
  Change change;
  change.cause = static_cast<terrain::Cause>(testing::between(random, 0, 2));
  const int steps = testing::between(random, 0, 30);
  for (int i = 0; i < steps; ++i) {
    const std::uint64_t most =
        testing::chance(random, 0.8) ? 1000 : std::numeric_limits<std::uint64_t>::max();
    Step step{VertexId(testing::between<std::uint64_t>(random, 1, most)), std::nullopt, std::nullopt};
    const int parts = testing::between(random, 1, 3);
    if ((parts & 1) != 0) step.before = testing::any_placement(random);
    if ((parts & 2) != 0) step.after = testing::any_placement(random);
    change.steps.push_back(step);
  }
  return change;
}

TEST(ChangeCodecTest, BytesAreAsSpecified) {
  Change change;
  change.steps.push_back({VertexId(3), std::nullopt, Placement{{1, -2}, 0.5}});
  change.steps.push_back({VertexId(2), Placement{{64, -2}, 1.0}, Placement{{64, -2}, -2.0}});
  const unsigned char golden[] = {
      'T',  'N',  'S',  'J',  1, 0,                             // magic, version
      2,                                                        // steps
      2,    6,    2,    3,    0, 0, 0, 0, 0, 0,    0xe0, 0x3f,  // inserted 3 (+3) at (+1, -2), z 0.5
      3,    1,    0x7e, 0,    0, 0, 0, 0, 0, 0,    0xf0, 0x3f,  // set 2 (-1) at (+63, +0) from z 1
      0,    0,    0,    0,    0, 0, 0, 0, 0, 0xc0,              // to z -2 at (+0, +0)
      0xf8, 0x53, 0x0a, 0x7f,                                   // CRC-32C of all this
  };
  EXPECT_EQ(encode_change(change), std::string(reinterpret_cast<const char*>(golden), sizeof golden));
}

TEST(ChangeCodecTest, EmptyChangesHaveBytesToo) {
  const auto decoded = decode_change(encode_change(Change{}));
  ASSERT_TRUE(decoded.ok());
  EXPECT_TRUE(decoded->steps.empty());
}

TEST(ChangeCodecTest, RandomChangesRoundTrip) {
  Random random(testing::seed());
  for (int round = 0; round < 2000; ++round) {
    const Change change = any_change(random);
    const std::string bytes = encode_change(change);
    const auto decoded = decode_change(bytes);
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    ASSERT_EQ(*decoded, change);
    ASSERT_EQ(encode_change(*decoded), bytes);  // signed zeros too
  }
}

TEST(ChangeCodecTest, EveryTruncationIsAnError) {
  Random random(testing::seed());
  for (int round = 0; round < 20; ++round) {
    const std::string bytes = encode_change(any_change(random));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ASSERT_FALSE(decode_change(bytes.substr(0, size)).ok()) << size << " of " << bytes.size();
    }
    ASSERT_FALSE(decode_change(bytes + '\0').ok());
  }
}

TEST(ChangeCodecTest, FlippedBitsAreAnError) {
  Random random(testing::seed());
  for (int round = 0; round < 5000; ++round) {
    const std::string bytes = encode_change(any_change(random));
    const std::string bad = testing::damaged(bytes, 1, random);
    const auto decoded = decode_change(bad);
    ASSERT_FALSE(decoded.ok());
    ASSERT_FALSE(decoded.error().message.empty());
  }
}

TEST(ChangeCodecTest, DamageBehindAFittingChecksumIsAnErrorOrAnotherChange) {
  Random random(testing::seed());
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string bad =
        testing::damaged(encode_change(any_change(random)), testing::between(random, 1, 4), random);
    if (testing::chance(random, 0.2)) bad.resize(testing::between<std::size_t>(random, 0, bad.size()));
    bad = testing::resummed(bad);
    const auto decoded = decode_change(bad);
    if (!decoded.ok()) continue;
    ++accepted;
    ASSERT_EQ(encode_change(*decoded), bad);
  }
  EXPECT_GT(accepted, 0);
}

TEST(ChangeCodecTest, ArbitraryBytesNeverCrash) {
  Random random(testing::seed());
  for (int round = 0; round < 20000; ++round) {
    ASSERT_FALSE(decode_change(testing::any_text(random)).ok());
    const std::string head("TNSJ\x01\x00", 6);
    const std::string bytes = testing::resummed(head + testing::any_text(random) + "....");
    const auto decoded = decode_change(bytes);
    if (decoded.ok()) {
      ASSERT_EQ(encode_change(*decoded), bytes);
    }
  }
}

TEST(ChangeCodecTest, EachCauseGoesWithItsVersionAndNoOtherIsKnown) {
  Change change;
  EXPECT_EQ(encode_change(change)[4], 1);
  struct Case {
    terrain::Cause cause;
    char version;
    std::vector<char> others;
  };
  for (const Case& one : {Case{terrain::Cause::kRevert, 2, {0, 3, 4}}, Case{terrain::Cause::kSimplification, 2, {0, 3, 4}},
                          Case{terrain::Cause::kUndo, 3, {0, 1, 2, 4}}}) {
    change.cause = one.cause;
    std::string bytes = encode_change(change);
    EXPECT_EQ(bytes[4], one.version);
    EXPECT_EQ(decode_change(bytes)->cause, one.cause);
    for (const char cause : one.others) {
      bytes[6] = cause;
      EXPECT_FALSE(decode_change(testing::resummed(bytes)).ok()) << int{cause};
    }
  }
}

TEST(ChangeCodecTest, HugeCountsAllocateNothing) {
  const std::string head("TNSJ\x01\x00\xff\xff\xff\xff\xff\xff\xff\xff\x7f", 15);
  const auto decoded = decode_change(testing::resummed(head + "...."));
  ASSERT_FALSE(decoded.ok());
  EXPECT_EQ(decoded.error().code, base::Code::kMalformed);
}

TEST(ChangeCodecTest, NewerVersionsAreRefused) {
  std::string bytes = encode_change(Change{});
  bytes[4] = 4;
  const auto decoded = decode_change(bytes);
  ASSERT_FALSE(decoded.ok());
  EXPECT_EQ(decoded.error().code, base::Code::kUnsupported);
}

// A record of one insertion whose bytes `spoil` changes; its checksum fits.
template <class Spoil>
base::Result<Change> decode_spoilt(Placement placement, Spoil spoil) {
  std::string bytes = encode_change({{{VertexId(1), std::nullopt, placement}}});
  spoil(bytes);
  return decode_change(testing::resummed(bytes));
}

TEST(ChangeCodecTest, MeaninglessStepsAreMalformed) {
  constexpr std::size_t kParts = 7, kId = 8, kX = 9, kZ = 11;
  const Placement origin{{0, 0}, 0};
  EXPECT_TRUE(decode_spoilt(origin, [](std::string&) {}).ok());
  EXPECT_FALSE(decode_spoilt(origin, [](std::string& b) { b[kParts] = 0; }).ok());
  EXPECT_FALSE(decode_spoilt(origin, [](std::string& b) { b[kParts] = 4; }).ok());
  EXPECT_FALSE(decode_spoilt(origin, [](std::string& b) { b[kId] = 0; }).ok());
  EXPECT_FALSE(
      decode_spoilt(origin, [](std::string& b) { b.replace(kZ, 8, "\0\0\0\0\0\0\xf0\x7f", 8); }).ok());
  EXPECT_FALSE(
      decode_spoilt(origin, [](std::string& b) { b.replace(kZ, 8, "\1\0\0\0\0\0\xf8\xff", 8); }).ok());
  // x = 2^29 - 1 is zigzag fe ff ff ff 03; the next even number is 2^29, just off the lattice.
  const Placement edge{{exact::kLatticeHalf - 1, 0}, 0};
  EXPECT_TRUE(decode_spoilt(edge, [](std::string&) {}).ok());
  const auto off = decode_spoilt(edge, [](std::string& b) { b.replace(kX, 5, "\x80\x80\x80\x80\x04"); });
  ASSERT_FALSE(off.ok());
  EXPECT_NE(off.error().message.find("lattice"), std::string::npos) << off.error().message;
}

}  // namespace
}  // namespace tin::codec
