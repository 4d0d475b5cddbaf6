#include "server/http/compress.h"

#include <zlib.h>
#include <zstd.h>

#include <array>
#include <new>
#include <optional>
#include <stdexcept>

#include "server/http/field_value.h"
#include "tin/base/check.h"

namespace server::http {
namespace {

// Low levels: most of the gain at a fraction of the time, which is the server's.
constexpr int kGzipLevel = 3;
constexpr int kZstdLevel = 3;
constexpr std::size_t kBlockBytes = 64 * 1024;
constexpr std::size_t kPieceBytes = 64 * 1024;  // of output, about, before a piece goes out

enum class Step { kGoOn, kFlush, kFinish };

/// A stream of compressed bytes.
class Compressor {
 public:
  virtual ~Compressor() = default;
  /// Takes all of `in` and appends what comes out.
  virtual void put(std::string_view in, Step step, std::string& out) = 0;
};

class GzipCompressor final : public Compressor {
 public:
  GzipCompressor() {
    constexpr int kGzipWrapper = 16;
    if (deflateInit2(&stream_, kGzipLevel, Z_DEFLATED, MAX_WBITS + kGzipWrapper, 8, Z_DEFAULT_STRATEGY) !=
        Z_OK)
      throw std::bad_alloc();
  }
  ~GzipCompressor() override { deflateEnd(&stream_); }
  GzipCompressor(const GzipCompressor&) = delete;
  GzipCompressor& operator=(const GzipCompressor&) = delete;

  void put(std::string_view in, Step step, std::string& out) override {
    // zlib counts in 32 bits.
    constexpr std::size_t kMost = std::size_t{1} << 30;
    for (; in.size() > kMost; in.remove_prefix(kMost)) put_some(in.substr(0, kMost), Z_NO_FLUSH, out);
    put_some(in, step == Step::kFinish ? Z_FINISH : step == Step::kFlush ? Z_SYNC_FLUSH : Z_NO_FLUSH, out);
  }

 private:
  void put_some(std::string_view in, int flush, std::string& out) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data()));  // zlib does not write there
    stream_.avail_in = static_cast<uInt>(in.size());
    do {
      stream_.next_out = block_.data();
      stream_.avail_out = static_cast<uInt>(block_.size());
      TIN_CHECK(deflate(&stream_, flush) != Z_STREAM_ERROR);
      out.append(reinterpret_cast<const char*>(block_.data()), block_.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
  }

  z_stream stream_{};
  std::array<Bytef, kBlockBytes> block_;
};

class ZstdCompressor final : public Compressor {
 public:
  ZstdCompressor() : context_(ZSTD_createCCtx(), &ZSTD_freeCCtx) {
    if (!context_) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, kZstdLevel);
  }

  void put(std::string_view in, Step step, std::string& out) override {
    const ZSTD_EndDirective directive = step == Step::kFinish  ? ZSTD_e_end
                                        : step == Step::kFlush ? ZSTD_e_flush
                                                               : ZSTD_e_continue;
    ZSTD_inBuffer input{in.data(), in.size(), 0};
    while (true) {
      ZSTD_outBuffer output{block_.data(), block_.size(), 0};
      const std::size_t left = ZSTD_compressStream2(context_.get(), &output, &input, directive);
      if (ZSTD_isError(left) != 0) throw std::runtime_error(ZSTD_getErrorName(left));
      out.append(block_.data(), output.pos);
      if (directive == ZSTD_e_continue ? input.pos == input.size : left == 0) return;
    }
  }

 private:
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context_;
  std::array<char, kBlockBytes> block_;
};

std::unique_ptr<Compressor> make_compressor(Encoding encoding) {
  if (encoding == Encoding::kGzip) return std::make_unique<GzipCompressor>();
  TIN_CHECK(encoding == Encoding::kZstd);
  return std::make_unique<ZstdCompressor>();
}

class CompressingSource final : public BodySource {
 public:
  CompressingSource(std::unique_ptr<BodySource> source, Encoding encoding)
      : source_(std::move(source)), compressor_(make_compressor(encoding)) {}

  bool next(std::string& piece) override {
    while (!ended_ && piece.size() < kPieceBytes) {
      raw_.clear();
      ended_ = !source_->next(raw_);
      const bool waits = !ended_ && raw_.empty();
      compressor_->put(raw_, ended_ ? Step::kFinish : waits && pending_ ? Step::kFlush : Step::kGoOn, piece);
      pending_ = !waits;
      // What is there already need not wait for the rest of a slow source.
      if (waits) return true;
    }
    return !piece.empty();
  }

 private:
  std::unique_ptr<BodySource> source_;
  std::unique_ptr<Compressor> compressor_;
  std::string raw_;
  bool pending_ = false;  // something went in since the last flush
  bool ended_ = false;
};

}  // namespace

std::string_view encoding_name(Encoding encoding) {
  return encoding == Encoding::kGzip ? "gzip" : encoding == Encoding::kZstd ? "zstd" : "";
}

Encoding choose_encoding(std::string_view field) {
  const auto accepted = parse_preferences(field);
  if (!accepted) return Encoding::kIdentity;
  std::optional<double> gzip, zstd, any;
  for (const auto& [name, weight] : *accepted) {
    if (name == "gzip" || name == "x-gzip") gzip = weight;
    if (name == "zstd") zstd = weight;
    if (name == "*") any = weight;
  }
  const double for_gzip = gzip.value_or(any.value_or(0)), for_zstd = zstd.value_or(any.value_or(0));
  if (for_gzip == 0 && for_zstd == 0) return Encoding::kIdentity;
  return for_zstd >= for_gzip ? Encoding::kZstd : Encoding::kGzip;
}

bool compressible(std::string_view content_type) {
  const std::string type = lower_case(trimmed(content_type.substr(0, content_type.find(';'))));
  if (type == "text/event-stream") return false;
  return type.starts_with("text/") || type == "application/json" || type == "application/xml" ||
         type.ends_with("+json") || type.ends_with("+xml") || type == "application/vnd.oai.openapi+json" ||
         type == "model/obj" || type == "application/javascript";
}

std::string compress(std::string_view text, Encoding encoding) {
  std::string out;
  make_compressor(encoding)->put(text, Step::kFinish, out);
  return out;
}

std::unique_ptr<BodySource> compressing(std::unique_ptr<BodySource> source, Encoding encoding) {
  return std::make_unique<CompressingSource>(std::move(source), encoding);
}

}  // namespace server::http
