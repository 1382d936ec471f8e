// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/manifest.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>

#include <nlohmann/json.hpp>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace {

using nlohmann::json;

/// Reads the text for the parser and remembers how far it has come: events tell no place.
class Cursor {
public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  explicit Cursor(const char** at) : at_(at) {}
  Cursor(const char** at, const char* end) : at_(at), end_(end) {}
  reference operator*() const { return **at_; }
  Cursor& operator++() {
    ++*at_;
    return *this;
  }
  bool operator==(const Cursor& other) const { return *at_ == (other.end_ != nullptr ? other.end_ : *other.at_); }
  bool operator!=(const Cursor& other) const { return !(*this == other); }

private:
  const char** at_;
  const char* end_ = nullptr;
};

/// Places of offsets; quick for offsets that grow.
class Places {
public:
  explicit Places(std::string_view text) : text_(text) {}

  TextPlace find(std::size_t offset) {
    if (offset < offset_) {
      offset_ = 0;
      place_ = {};
    }
    for (; offset_ < offset; ++offset_) {
      if (text_[offset_] == '\n') {
        ++place_.line;
        place_.column = 1;
      } else if ((text_[offset_] & 0xC0) != 0x80) {
        ++place_.column;
      }
    }
    return place_;
  }

private:
  std::string_view text_;
  std::size_t offset_ = 0;
  TextPlace place_;
};

/// What numbers and words are made of.
bool belongs_to_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.'; }

/// Where the token begins whose last character stands before `end`.
std::size_t token_start(std::string_view text, std::size_t end) {
  std::size_t start = end - 1;
  if (text[start] == '"') {
    const auto is_escaped = [&](std::size_t i) {
      std::size_t slashes = 0;
      while (i > slashes && text[i - 1 - slashes] == '\\') ++slashes;
      return slashes % 2 == 1;
    };
    do
      start = text.rfind('"', start - 1);
    while (start != 0 && is_escaped(start));
    return start;
  }
  while (start > 0 && belongs_to_word(text[start]) && belongs_to_word(text[start - 1])) --start;
  return start;
}

class Reader : public json::json_sax_t {
public:
  Reader(std::string_view text, const std::string& name) : text_(text), name_(name), at_(text.data()), places_(text) {}

  Manifest read() {
    const Cursor begin(&at_), end(&at_, text_.data() + text_.size());
    json::sax_parse(begin, end, this);
    if (!root_keys_.contains("scenes")) throw Error(ErrorCode::input, name_ + ": has no \"scenes\"");
    return std::move(manifest_);
  }

  bool null() override { return literal("", ManifestOption::Kind::off); }
  bool boolean(bool value) override { return literal("", value ? ManifestOption::Kind::on : ManifestOption::Kind::off); }
  bool number_integer(number_integer_t value) override { return number(std::to_string(value)); }
  bool number_unsigned(number_unsigned_t value) override { return number(std::to_string(value)); }
  bool number_float(number_float_t, const string_t& spelled) override { return number(spelled); }
  bool binary(binary_t&) override { return false; }

  bool string(string_t& value) override {
    if (value.find('\0') != std::string::npos) refuse("holds a NUL character");
    if (state_ == State::scenes) {
      manifest_.scenes.push_back({value, "", {}, here()});
      if (value.empty()) refuse("is empty");
      return true;
    }
    if (state_ == State::scene && (key_ == "input" || key_ == "output")) {
      if (value.empty()) refuse("is empty");
      (key_ == "input" ? manifest_.scenes.back().input : manifest_.scenes.back().output) = value;
      return true;
    }
    return literal(value, ManifestOption::Kind::text, true);
  }

  bool start_object(std::size_t) override {
    switch (state_) {
    case State::start:
      state_ = State::root;
      return true;
    case State::root:
      if (key_ != "defaults") refuse(key_ == "scenes" ? "must be a list" : "must be an object");
      state_ = State::defaults;
      return true;
    case State::scenes:
      manifest_.scenes.push_back({"", "", {}, here()});
      state_ = State::scene;
      return true;
    default:
      refuse("needs a text, a number, true, false or a list of numbers, got an object");
    }
  }

  bool key(string_t& key) override {
    key_ = key;
    key_place_ = here();
    if (state_ == State::root && key != "defaults" && key != "scenes") refuse("no such key; there are \"defaults\" and \"scenes\"");
    if (state_ == State::defaults && (key == "input" || key == "output")) refuse("belongs to a scene");
    if (!keys(state_).insert(key).second) refuse("stands here twice");
    return true;
  }

  bool end_object() override {
    if (state_ == State::scene && manifest_.scenes.back().input.empty()) {
      key_.clear();
      key_place_ = manifest_.scenes.back().place;
      refuse("has no \"input\"");
    }
    keys_.clear();
    state_ = state_ == State::scene ? State::scenes : State::root;
    return true;
  }

  bool start_array(std::size_t) override {
    if (state_ == State::root && key_ == "scenes") {
      state_ = State::scenes;
      return true;
    }
    if ((state_ != State::defaults && state_ != State::scene) || key_ == "input" || key_ == "output") refuse("must not be a list");
    outside_ = state_;
    state_ = State::numbers;
    numbers_.clear();
    return true;
  }

  bool end_array() override {
    if (state_ == State::scenes) {
      state_ = State::root;
      return true;
    }
    state_ = outside_;
    return literal(numbers_, ManifestOption::Kind::text);
  }

  bool parse_error(std::size_t byte, const std::string&, const json::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ...: ...; last read: ..."
    std::string message = error.what();
    if (const std::size_t colon = message.find(": "); colon != std::string::npos) message.erase(0, colon + 2);
    const std::size_t offset = std::min(byte > 0 ? byte - 1 : 0, text_.size());
    throw Error(ErrorCode::input, to_string(name_, places_.find(offset)) + ": is no JSON: " + message);
  }

private:
  enum class State { start, root, defaults, scenes, scene, numbers };

  std::set<std::string>& keys(State state) { return state == State::root ? root_keys_ : keys_; }

  /// The parser has read one character beyond a number.
  bool number(const std::string& spelled) {
    after_number_ = true;
    literal(spelled, ManifestOption::Kind::text);
    after_number_ = false;
    return true;
  }

  /// The place of the token just read.
  TextPlace here() {
    std::size_t end = std::max<std::size_t>(static_cast<std::size_t>(at_ - text_.data()), 1);
    if (after_number_ && end > 1 && !belongs_to_word(text_[end - 1])) --end;
    return places_.find(token_start(text_, end));
  }

  std::string path() const {
    std::string scene = "scenes[" + std::to_string(manifest_.scenes.empty() ? 0 : manifest_.scenes.size() - 1) + "]";
    switch (outermost()) {
    case State::root: return key_;
    case State::defaults: return "defaults." + key_;
    case State::scenes: return scene;
    case State::scene: return key_.empty() ? scene : scene + "." + key_;
    default: return "manifest";
    }
  }

  State outermost() const { return state_ == State::numbers ? outside_ : state_; }

  [[noreturn]] void refuse(const std::string& what) {
    const bool has_key = outermost() == State::root || outermost() == State::defaults || outermost() == State::scene;
    throw Error(ErrorCode::input, to_string(name_, has_key ? key_place_ : here()) + ": " + path() + ": " + what);
  }

  bool literal(const std::string& value, ManifestOption::Kind kind, bool is_string = false) {
    if (state_ == State::start) refuse("must be an object with \"scenes\"");
    if (state_ == State::root) refuse(key_ == "scenes" ? "must be a list" : "must be an object");
    if (state_ == State::scenes) {
      manifest_.scenes.emplace_back();
      refuse("must be a file name or an object");
    }
    if (state_ == State::numbers) {
      if (is_string || kind != ManifestOption::Kind::text) refuse("must be a list of numbers");
      numbers_ += (numbers_.empty() ? "" : ",") + value;
      return true;
    }
    if (key_ == "input" || key_ == "output") refuse("must be a text");
    auto& options = state_ == State::defaults ? manifest_.defaults : manifest_.scenes.back().options;
    options.push_back({key_, value, kind, key_place_});
    return true;
  }

  std::string_view text_;
  const std::string& name_;
  const char* at_;
  Places places_;
  Manifest manifest_;
  State state_ = State::start, outside_ = State::start;
  std::string key_, numbers_;
  bool after_number_ = false;
  TextPlace key_place_;
  std::set<std::string> root_keys_, keys_;
};

} // namespace

std::string to_string(const std::string& name, const TextPlace& place) {
  return name + ":" + std::to_string(place.line) + ":" + std::to_string(place.column);
}

Manifest parse_manifest(std::string_view text, const std::string& name) { return Reader(text, name).read(); }

} // namespace domewarp
