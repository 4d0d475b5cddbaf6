// Compression of answers for clients that ask for it (RFC 9110, 12.5.3 and 8.4).
//
//   const Encoding encoding = choose_encoding("gzip, zstd;q=0.9, *;q=0");  // kGzip
//   if (compressible("application/geo+json")) source = compressing(std::move(source), encoding);
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "server/http/message.h"

namespace server::http {

enum class Encoding { kIdentity, kGzip, kZstd };

/// "gzip" or "zstd"; "" for identity.
std::string_view encoding_name(Encoding encoding);

/// What an Accept-Encoding field likes best of what there is; zstd where it likes both alike. An absent or
/// malformed field means identity, which nobody is refused.
Encoding choose_encoding(std::string_view accept_encoding);

/// Whether bodies of this media type get smaller: text, JSON, XML. Not event streams, which must not wait.
bool compressible(std::string_view content_type);

/// `text`, compressed. Cost: some 300 MB/s for zstd, 80 MB/s for gzip. Throws bad_alloc.
std::string compress(std::string_view text, Encoding encoding);

/// A source that compresses what another one gives, piece by piece: it holds some hundred KB. A source that
/// has nothing yet makes it send what it has.
std::unique_ptr<BodySource> compressing(std::unique_ptr<BodySource> source, Encoding encoding);

}  // namespace server::http
