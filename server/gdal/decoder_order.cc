#include "server/gdal/decoder_order.h"

#include <cstring>
#include <type_traits>

#include "server/gdal/import_wire.h"

namespace server::gdal {

static_assert(std::is_trivially_copyable_v<DecoderLimits>);

std::string encode_order(const DecoderOrder& order) {
  return std::string(reinterpret_cast<const char*>(&order.limits), sizeof order.limits) +
         encode_options(order.options);
}

tin::base::Result<DecoderOrder> decode_order(std::string_view bytes) {
  DecoderOrder order;
  if (bytes.size() < sizeof order.limits)
    return tin::base::error(tin::base::Code::kMalformed, "The order to the decoder is cut");
  std::memcpy(&order.limits, bytes.data(), sizeof order.limits);
  auto options = decode_options(bytes.substr(sizeof order.limits));
  if (!options) return options.error();
  order.options = *std::move(options);
  return order;
}

}  // namespace server::gdal
