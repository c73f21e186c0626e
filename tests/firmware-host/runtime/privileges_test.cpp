// What the system granted, in words.
#include "firmware-host/runtime/privileges.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <thread>

#include "firmware-host/runtime/process_setup.h"

namespace pelorus {
namespace {

TEST(Privileges, AllGrantedIsOneShortLine) {
  PrivilegeLedger ledger;
  ledger.note_realtime("");
  ledger.note_memory_lock("");
  ledger.note_thread("vision", true, "");
  ledger.note_thread("klt", true, "");
  ledger.note_thread("surf", false, "");
  EXPECT_EQ(ledger.text(), "real time, memory locked, 2 threads pinned");
  EXPECT_TRUE(ledger.refused().empty());
}

TEST(Privileges, WhatWasNotAskedForIsNoRefusal) {
  const PrivilegeLedger ledger;
  EXPECT_EQ(ledger.text(), "real time not asked for, memory lock not asked for, no threads pinned");
  EXPECT_TRUE(ledger.refused().empty());
}

TEST(Privileges, EachRefusalIsNamedWithItsReason) {
  PrivilegeLedger ledger;
  ledger.note_realtime("Operation not permitted");
  ledger.note_memory_lock("the limit is 64 kB");
  ledger.note_reserved_memory("Invalid argument");
  ledger.note_thread("vision", true, "");
  ledger.note_thread("klt", true, "Invalid argument");
  EXPECT_EQ(ledger.text(),
            "no real time: Operation not permitted, memory not locked: the limit is 64 kB, 1 threads pinned, reserved "
            "memory not populated: Invalid argument, thread klt refused: Invalid argument");
  const std::vector<std::string> expected{
      "memory lock: the limit is 64 kB", "reserved memory populated: Invalid argument",
      "real-time scheduling: Operation not permitted", "class or processor of thread klt: Invalid argument"};
  EXPECT_EQ(ledger.refused(), expected);
}

// A processor that does not exist: what the kernel answers reaches the text.
TEST(Privileges, APinThatTheKernelRefusesIsTold) {
  PrivilegeLedger ledger;
  std::thread([&ledger] {
    ledger.note_thread("nowhere", true, set_thread("nowhere", ThreadClass::normal, CPU_SETSIZE - 1));
  }).join();
  ASSERT_EQ(ledger.refused().size(), 1U);
  EXPECT_NE(ledger.text().find("no threads pinned, thread nowhere refused: Invalid argument"), std::string::npos)
      << ledger.text();
}

}  // namespace
}  // namespace pelorus
