#pragma once
// Does a GigE Vision camera still answer? One question to its control port, without Aravis, which takes 2.5 s to 10 s
// to find that out. Thread-safe.

#include <netinet/in.h>

#include <chrono>
#include <optional>
#include <string>

namespace pelorus {

// "127.0.0.1" as the address of a camera's control port; empty for anything that is no IPv4 address.
[[nodiscard]] std::optional<sockaddr_in> gvcp_address(const std::string& text);

// Reads a register that every camera has (its version) and that needs no control over the camera. Asks twice, each
// time waiting for `patience` at most.
[[nodiscard]] bool answers_gvcp(const sockaddr_in& camera,
                                std::chrono::milliseconds patience = std::chrono::milliseconds(100));

}  // namespace pelorus
