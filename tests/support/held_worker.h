#pragma once
// A side worker that keeps its piece until it is waited for: as slow as a thread can be.

#include "core/base/side_worker.h"

namespace pelorus::test {

class HeldWorker final : public SideWorker {
 public:
  void start(SideWork work) override {
    work_ = work;
    done_ = false;
  }
  [[nodiscard]] bool done() const override { return done_; }
  void wait() override {
    if (!done_) work_.run(work_.on);
    done_ = true;
  }

 private:
  SideWork work_;
  bool done_ = true;
};

}  // namespace pelorus::test
