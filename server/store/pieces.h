// Bytes that are too many to be in memory at once.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "tin/base/result.h"
#include "tin/codec/sink.h"

namespace server::store {

/// Takes the next piece. What it returns as an error ends the giving.
using Sink = tin::codec::Sink;

/// Gives all pieces to a sink, in order. Returns the sink's error, or its own.
using Pieces = std::function<tin::base::Result<void>(const Sink& sink)>;

/// Takes the next piece, and is told how many bytes there are in all.
using MeasuredSink = std::function<tin::base::Result<void>(std::string_view piece, std::uint64_t whole)>;

}  // namespace server::store
