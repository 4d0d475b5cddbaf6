// Checked reading of JSON that anyone may have sent.
//
//   auto document = Document::parse(body);              // Result: syntax, UTF-8, depth, duplicate names
//   auto request = document->root().object({"x", "y"}); // Result: an object without other members
//   auto x = request->require("x");                     // Result: the member
//   auto value = x->number();                           // Result: a finite double; errors say where: "/x"
//
// Errors: kMalformed for syntax, a wrong type, a missing or unknown member; kNotFinite for a number that no
// double holds; kInvalidValue for an integer out of its range; kTooLarge for an array or string over its
// limit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tin/base/result.h"

namespace proto {

/// Arrays and objects may stand inside one another to this depth.
inline constexpr std::size_t kMaxJsonDepth = 64;

class Value;

/// A parsed text: a flat array of nodes in the order of the text, 24 bytes each. Values point into it.
class Document {
 public:
  static tin::base::Result<Document> parse(std::string_view text);
  Value root() const;

 private:
  friend class Value;
  friend class Array;
  friend class Object;
  friend class DocumentBuilder;

  enum class Kind : std::uint8_t {
    kNull,
    kFalse,
    kTrue,
    kSigned,
    kUnsigned,
    kDouble,
    kString,
    kArray,
    kObject
  };
  struct Slice {
    std::uint32_t offset;
    std::uint32_t length;
  };
  union Content {
    std::uint64_t unsigned_integer = 0;
    std::int64_t signed_integer;
    double real;
    Slice string;
    std::uint64_t count;  // of an array's items or an object's members
  };
  struct Node {
    Kind kind = Kind::kNull;
    std::uint32_t end = 0;  // index of the node after this one and all that is in it
    Slice name{};           // of a member
    Content content;
  };

  std::string_view text_of(Slice slice) const {
    return std::string_view(strings_).substr(slice.offset, slice.length);
  }
  std::string pointer_to(std::uint32_t index) const;

  std::vector<Node> nodes_;
  std::string strings_;
};

/// The items of an array, to be walked with a range-for.
class Array {
 public:
  class Iterator {
   public:
    Iterator(const Document* document, std::uint32_t index) : document_(document), index_(index) {}
    Value operator*() const;
    Iterator& operator++();
    friend bool operator==(const Iterator&, const Iterator&) = default;

   private:
    const Document* document_;
    std::uint32_t index_;
  };
  Iterator begin() const { return {document_, index_ + 1}; }
  Iterator end() const { return {document_, document_->nodes_[index_].end}; }
  std::size_t size() const { return document_->nodes_[index_].content.count; }

 private:
  friend class Value;
  Array(const Document* document, std::uint32_t index) : document_(document), index_(index) {}
  const Document* document_;
  std::uint32_t index_;
};

/// The members of an object, by name.
class Object {
 public:
  std::optional<Value> find(std::string_view name) const;
  tin::base::Result<Value> require(std::string_view name) const;

 private:
  friend class Value;
  Object(const Document* document, std::uint32_t index) : document_(document), index_(index) {}
  const Document* document_;
  std::uint32_t index_;
};

/// One value of a document, which must outlive it.
class Value {
 public:
  bool is_array() const { return node().kind == Document::Kind::kArray; }
  bool is_null() const { return node().kind == Document::Kind::kNull; }
  tin::base::Result<bool> boolean() const;
  /// A finite number.
  tin::base::Result<double> number() const;
  /// A whole number within [min, max]; 3.0 is one, 3.5 is not. Requires: max >= 0.
  tin::base::Result<std::int64_t> integer(std::int64_t min, std::int64_t max) const;
  tin::base::Result<std::string_view> string(std::size_t max_bytes) const;
  tin::base::Result<Array> array(std::size_t max_items) const;
  /// An object that has no members but these.
  tin::base::Result<Object> object(std::initializer_list<std::string_view> allowed) const;
  /// An object whose members are not our business.
  tin::base::Result<Object> any_object() const;

  /// Where it stands: "/ops/3/x"; empty for the root.
  std::string pointer() const { return document_->pointer_to(index_); }
  /// An error about this value.
  tin::base::Error error(tin::base::Code code, std::string message) const;

 private:
  friend class Document;
  friend class Array::Iterator;
  friend class Object;
  Value(const Document* document, std::uint32_t index) : document_(document), index_(index) {}
  const Document::Node& node() const { return document_->nodes_[index_]; }
  tin::base::Error not_a(std::string_view wanted) const;

  const Document* document_;
  std::uint32_t index_;
};

}  // namespace proto
