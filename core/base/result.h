#pragma once
// Result<T>: a value, or an Error that names the place, what is wrong and the cure (CONVENTIONS, errors).
// For the environment (files, devices, configuration); ordinary outcomes of a stage are enums instead.

#include <string>
#include <utility>
#include <variant>

#include "core/base/check.h"

namespace pelorus {

// Doubles as the exit code family of the programs: see exit_code().
enum class ErrorCode { bad_usage, bad_input, bad_calibration, bad_configuration, io, unsupported, device };

struct Error {
  ErrorCode code = ErrorCode::bad_input;
  std::string place;                          // file, file:line, frame or device: where the user has to look
  std::string detail;                         // what is wrong, with the offending values
  std::string cure;                           // what to do about it; may be empty when detail says it all
  [[nodiscard]] std::string message() const;  // "place: detail (cure)"
};

// Process exit code for an error: 2 usage, 3 bad input, 4 calibration, 5 configuration, 6 input/output, 7 device.
[[nodiscard]] int exit_code(ErrorCode code);

struct Ok {};

template <class T = Ok>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  [[nodiscard]] bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] T& value() {
    PELORUS_CHECK(ok(), "value() of a failed Result");
    return std::get<0>(state_);
  }
  [[nodiscard]] const T& value() const {
    PELORUS_CHECK(ok(), "value() of a failed Result");
    return std::get<0>(state_);
  }
  [[nodiscard]] const Error& error() const {
    PELORUS_CHECK(!ok(), "error() of a successful Result");
    return std::get<1>(state_);
  }

 private:
  std::variant<T, Error> state_;
};

}  // namespace pelorus
