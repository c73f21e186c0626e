#include "core/base/result.h"

namespace pelorus {

std::string Error::message() const {
  std::string text = place.empty() ? detail : place + ": " + detail;
  if (!cure.empty()) text += " (" + cure + ")";
  return text;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_usage:
      return 2;
    case ErrorCode::bad_input:
      return 3;
    case ErrorCode::bad_calibration:
      return 4;
    case ErrorCode::bad_configuration:
      return 5;
    case ErrorCode::io:
      return 6;
    case ErrorCode::unsupported:
      return 3;
    case ErrorCode::device:
      return 7;
  }
  return 1;
}

}  // namespace pelorus
