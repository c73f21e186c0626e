#pragma once
// Recorded pairs as software cameras show them, and what each of them showed when. Thread-bound.

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "drivers/replay/dataset.h"

namespace pelorus {

struct Film {
  std::vector<Image> frames[2];

  [[nodiscard]] static Result<Film> load(const std::string& dataset) {
    auto source = open_dataset(dataset);
    if (!source) return source.error();
    Film film;
    while (true) {
      SourcePair pair;
      const Result<bool> read = source.value()->next(pair);
      if (!read) return read.error();
      if (!read.value()) return film;
      film.frames[0].push_back(std::move(pair.left));
      film.frames[1].push_back(std::move(pair.right));
    }
  }
  // Which of `count` frames is shown at a tick of the period. Forth and back, so that its motion never jumps:
  // 0, 1, ..., n-1, n-2, ..., 1, 0, 1, ...
  [[nodiscard]] static std::size_t index_at(std::int64_t tick, std::size_t count) {
    const auto n = static_cast<std::int64_t>(count);
    if (n == 1) return 0;
    const std::int64_t phase = tick % (2 * n - 2);
    return static_cast<std::size_t>(phase < n ? phase : 2 * n - 2 - phase);
  }
};

struct Shown {
  std::int64_t time_ns;
  std::size_t frame;
};

// A row for each picture that either camera took: side, time on the wall clock, index in the recording.
inline bool write_shown(const char* path, const std::vector<Shown>& left, const std::vector<Shown>& right) {
  std::FILE* file = std::fopen(path, "w");
  if (file == nullptr) return false;
  for (const auto* side : {&left, &right}) {
    for (const Shown& shown : *side) {
      std::fprintf(file, "%s,%lld,%zu\n", side == &left ? "left" : "right", static_cast<long long>(shown.time_ns),
                   shown.frame);
    }
  }
  return std::fclose(file) == 0;
}

}  // namespace pelorus
