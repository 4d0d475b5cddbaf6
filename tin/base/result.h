// Errors that a caller can meet, and values that may be missing because of one.
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "tin/base/check.h"

namespace tin::base {

/// Why something could not be done. proto/problems.h maps each to an HTTP status by an exhaustive switch.
enum class Code {
  kMalformed,          // not parsable, wrong type, wrong syntax
  kUnknownParameter,   // a query parameter that the resource does not have
  kNotFound,           // no such TIN, vertex collection, job ...
  kUnknownVertex,      // well-formed edit of a vertex id that is not there
  kNotFinite,          // NaN or infinite number
  kOutsideLattice,     // position further than 2^29 steps from the origin
  kDuplicatePosition,  // a vertex is there already and the policy is "reject"
  kInvalidValue,       // well-formed but impossible: negative tolerance, empty bbox ...
  kUnsupported,        // a media type, format or CRS that we do not read or write
  kConflict,           // id taken, state does not allow it
  kPrecondition,       // If-Match did not match
  kGone,               // a page token whose revision is no longer kept
  kTooLarge,           // body, raster, vertex count over a limit
  kTooMany,            // queues or connections full: try later
  kCancelled,          // stopped on request
  kStorage,            // the store could not write
  kNoSpace,            // the store has no room left
  kInternal,           // our bug or the environment's
};

/// An error with a sentence for people and, where it helps, the place: a JSON pointer, a parameter, an index.
struct Error {
  Code code = Code::kInternal;
  std::string message;
  std::string where;  // for example "/ops/3/x" or "query:bbox"; empty when there is no place
};

/// A value of type T, or an Error.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}       // NOLINT: implicit by intent
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit by intent

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { TIN_CHECK(ok()); return *std::get_if<0>(&state_); }
  const T& value() const& { TIN_CHECK(ok()); return *std::get_if<0>(&state_); }
  T&& value() && { TIN_CHECK(ok()); return std::move(*std::get_if<0>(&state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Error& error() const& { TIN_CHECK(!ok()); return *std::get_if<1>(&state_); }
  Error&& error() && { TIN_CHECK(!ok()); return std::move(*std::get_if<1>(&state_)); }

 private:
  std::variant<T, Error> state_;
};

/// Success without a value, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT: implicit by intent

  bool ok() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const Error& error() const& { TIN_CHECK(!ok_); return error_; }
  Error&& error() && { TIN_CHECK(!ok_); return std::move(error_); }

 private:
  Error error_;
  bool ok_ = true;
};

inline Error error(Code code, std::string message, std::string where = {}) {
  return Error{code, std::move(message), std::move(where)};
}

}  // namespace tin::base
