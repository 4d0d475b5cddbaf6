#include "server/http/compress.h"

#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include "tests/server/http/fixture.h"

namespace tests::server_http {
namespace {

using server::http::choose_encoding;
using server::http::compressible;
using server::http::Encoding;

std::string gunzip(const std::string& bytes) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, MAX_WBITS + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  int state = Z_OK;
  while (state == Z_OK) {
    Bytef block[4096];
    stream.next_out = block;
    stream.avail_out = sizeof block;
    state = inflate(&stream, Z_NO_FLUSH);
    out.append(reinterpret_cast<const char*>(block), sizeof block - stream.avail_out);
  }
  EXPECT_EQ(state, Z_STREAM_END);
  EXPECT_EQ(stream.avail_in, 0U);
  inflateEnd(&stream);
  return out;
}

std::string unzstd(const std::string& bytes) {
  std::string out(std::size_t{4} << 20, '\0');
  ZSTD_DCtx* context = ZSTD_createDCtx();
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  EXPECT_EQ(ZSTD_decompressStream(context, &to, &in), 0U) << "the frame is whole";
  EXPECT_EQ(in.pos, in.size);
  ZSTD_freeDCtx(context);
  out.resize(to.pos);
  return out;
}

std::string lines(int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += "{\"id\":" + std::to_string(i) + "},\n";
  return out;
}

TEST(CompressTest, TheClientsWishDecides) {
  EXPECT_EQ(choose_encoding(""), Encoding::kIdentity);
  EXPECT_EQ(choose_encoding("gzip"), Encoding::kGzip);
  EXPECT_EQ(choose_encoding("GZip , deflate, br"), Encoding::kGzip);
  EXPECT_EQ(choose_encoding("gzip, deflate, br, zstd"), Encoding::kZstd);
  EXPECT_EQ(choose_encoding("gzip;q=1.0, zstd;q=0.9"), Encoding::kGzip);
  EXPECT_EQ(choose_encoding("gzip;q=0"), Encoding::kIdentity);
  EXPECT_EQ(choose_encoding("gzip;q=0, *"), Encoding::kZstd);
  EXPECT_EQ(choose_encoding("*;q=0"), Encoding::kIdentity);
  EXPECT_EQ(choose_encoding("br, deflate, identity"), Encoding::kIdentity);
  EXPECT_EQ(choose_encoding("gzip;level=9;q=0.5"), Encoding::kGzip) << "what else is said of it does not matter";
  for (const char* malformed : {"gzip;q=", "gzip;q=2", "gzip;q=-1", "gzip;q=nan", "gzip;q=1e0x"}) {
    EXPECT_EQ(choose_encoding(malformed), Encoding::kIdentity) << malformed;
  }
}

TEST(CompressTest, OnlyTextIsWorthIt) {
  for (const char* type : {"application/json", "application/geo+json; charset=utf-8", "text/csv", "TEXT/HTML",
                           "application/problem+json", "image/svg+xml", "application/xml"}) {
    EXPECT_TRUE(compressible(type)) << type;
  }
  for (const char* type : {"", "image/tiff; application=geotiff", "image/png", "application/octet-stream",
                           "text/event-stream", "application/geopackage+sqlite3"}) {
    EXPECT_FALSE(compressible(type)) << type;
  }
}

class CompressedTest : public HttpTest {
 protected:
  CompressedTest() {
    add(Method::kGet, "/text", [this](Request&) { return tagged(text_); });
    add(Method::kGet, "/tiff", [this](Request&) {
      Response response = tagged(text_);
      response.headers[0].second = "image/tiff";
      return response;
    });
    add(Method::kGet, "/encoded", [this](Request&) {
      Response response = tagged(text_);
      response.headers.emplace_back("Content-Encoding", "br");
      return response;
    });
    add(Method::kGet, "/stream", [this](Request&) {
      Response response = streaming([this](int i, std::string& piece) {
        piece = text_.substr(std::min<std::size_t>(text_.size(), 7000U * static_cast<unsigned>(i)), 7000);
        return !piece.empty();
      });
      response.headers = {{"Content-Type", "application/json"}, {"ETag", "\"7\""}};
      return response;
    });
  }
  static Response tagged(std::string body) {
    return {200, {{"Content-Type", "application/json"}, {"ETag", "\"7\""}}, std::move(body)};
  }
  RawAnswer accepting(const std::string& path, const std::string& encodings, const std::string& more = "") {
    return ask("GET " + path, "Accept-Encoding: " + encodings + "\r\n" + more);
  }
  const std::string text_ = lines(20'000);
};

TEST_F(CompressedTest, StringsAndStreamsComeEncodedAndWhole) {
  start();
  for (const char* path : {"/text", "/stream"}) {
    const RawAnswer gzip = accepting(path, "gzip"), zstd = accepting(path, "gzip, zstd"),
                    plain = ask(std::string("GET ") + path);
    EXPECT_EQ(gzip.header("content-encoding"), "gzip");
    EXPECT_EQ(gunzip(gzip.body), text_) << path;
    EXPECT_LT(gzip.body.size(), text_.size() / 4);
    EXPECT_EQ(zstd.header("content-encoding"), "zstd");
    EXPECT_EQ(unzstd(zstd.body), text_) << path;
    EXPECT_EQ(plain.header("content-encoding"), "");
    EXPECT_EQ(plain.body, text_);
    for (const RawAnswer* answer : {&gzip, &zstd, &plain})
      EXPECT_EQ(answer->header("vary"), "Accept-Encoding");
  }
}

TEST_F(CompressedTest, EachEncodingHasATagOfItsOwn) {
  start();
  EXPECT_EQ(ask("GET /text").header("etag"), "\"7\"");
  EXPECT_EQ(accepting("/text", "gzip").header("etag"), "\"7-gzip\"");
  EXPECT_EQ(accepting("/stream", "zstd").header("etag"), "\"7-zstd\"");
  const RawAnswer same = accepting("/text", "gzip", "If-None-Match: \"7-gzip\"\r\n");
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.header("etag"), "\"7-gzip\"");
  EXPECT_EQ(same.header("vary"), "Accept-Encoding");
  EXPECT_EQ(same.header("content-encoding"), "");
  EXPECT_EQ(accepting("/text", "gzip", "If-None-Match: \"7\"\r\n").status, 200);
  EXPECT_EQ(ask("GET /text", "If-None-Match: \"7-gzip\"\r\n").status, 200);
}

TEST_F(CompressedTest, WhatIsEncodedOrNoTextStaysAsItIs) {
  start();
  EXPECT_EQ(accepting("/tiff", "gzip, zstd").body, text_);
  EXPECT_EQ(accepting("/tiff", "gzip, zstd").header("vary"), "");
  EXPECT_EQ(accepting("/encoded", "gzip").header("content-encoding"), "br");
  EXPECT_EQ(accepting("/encoded", "gzip").body, text_);
  EXPECT_EQ(accepting("/hello", "gzip").body, "hello") << "too short to gain";
}

TEST_F(CompressedTest, TheLeastSizeIsASetting) {
  options_.compress_from_bytes = 5;
  start();
  EXPECT_EQ(gunzip(accepting("/hello", "gzip").body), "hello");
  server_.reset();
  options_.compress_from_bytes = 6;
  start();
  EXPECT_EQ(accepting("/hello", "gzip").body, "hello");
  server_.reset();
  options_.compress_from_bytes = 0;
  start();
  EXPECT_EQ(accepting("/stream", "gzip").body, text_);
}

TEST_F(CompressedTest, AHeadTellsTheSameWithoutALength) {
  start();
  const RawAnswer head = ask("HEAD /text", "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(head.header("content-encoding"), "gzip");
  EXPECT_EQ(head.header("etag"), "\"7-gzip\"");
  EXPECT_EQ(head.header("content-length"), "");
}

TEST_F(CompressedTest, ASourceThatPausesIsNotHeldBack) {
  add(Method::kGet, "/slow", [this](Request&) {
    Response response = streaming([this](int i, std::string& piece) {
      if (i == 0) piece = "first";
      if (i == 1) return true;  // nothing yet
      if (i == 2) gate_.pass();
      if (i == 2) piece = "second";
      return i < 3;
    });
    response.headers = {{"Content-Type", "text/plain"}};
    return response;
  });
  options_.poll_interval = std::chrono::milliseconds(1);
  start();
  RawClient client(port_);
  client.send("GET /slow HTTP/1.1\r\nHost: t\r\nAccept-Encoding: gzip\r\n\r\n");
  std::jthread opener([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    gate_.open();
  });
  EXPECT_EQ(gunzip(client.read_answer().body), "firstsecond");
}

}  // namespace
}  // namespace tests::server_http
