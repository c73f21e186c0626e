#pragma once
// Ownership of the objects of GLib. Thread-bound.

#include <arv.h>

#include <memory>
#include <string>

namespace pelorus {

struct GObjectUnref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using GObjectPtr = std::unique_ptr<T, GObjectUnref>;

// Takes the errors of a series of calls: `arv_...(..., failure.slot())`.
class GFailure {
 public:
  GFailure() = default;
  GFailure(const GFailure&) = delete;
  GFailure& operator=(const GFailure&) = delete;
  ~GFailure() { g_clear_error(&error_); }

  [[nodiscard]] GError** slot() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  [[nodiscard]] std::string message() const { return error_ != nullptr ? error_->message : "no reason given"; }

 private:
  GError* error_ = nullptr;
};

}  // namespace pelorus
