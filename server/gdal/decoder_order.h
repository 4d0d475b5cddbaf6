// What the two sides of a decoder agree on beside import_wire.h. For this folder only.
#pragma once

#include <string>
#include <string_view>

#include "server/gdal/import.h"
#include "server/gdal/sandbox.h"

namespace server::gdal {

/// The name of the file in the decoder's working folder.
inline constexpr const char* kUploadName = "upload";
/// The exit status of a decoder that could not confine itself, and so read nothing.
inline constexpr int kNotConfined = 3;

struct DecoderOrder {
  DecoderLimits limits;
  ImportOptions options;
};
std::string encode_order(const DecoderOrder& order);
/// Errors: kMalformed.
tin::base::Result<DecoderOrder> decode_order(std::string_view bytes);

}  // namespace server::gdal
