#pragma once
// McapWriter: an MCAP file (mcap.dev/spec, version 0) with chunks, message indexes, a summary and all its checksums, so
// that viewers seek in it and notice damage. Chunks are not compressed. Records go out in the order of the calls; the
// last part is held until finish(). Thread-bound; holds one chunk in memory and 16 bytes a message of it.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "firmware-host/runtime/partial_file.h"

namespace pelorus {

class McapWriter {
 public:
  [[nodiscard]] static Result<McapWriter> create(const std::filesystem::path& path, bool overwrite,
                                                 std::size_t chunk_bytes = 1 << 16);

  // A topic of JSON messages; `schema` is a JSON Schema. Returns its number. Before the first message.
  [[nodiscard]] std::uint16_t add_channel(const std::string& topic, const std::string& schema_name,
                                          const std::string& schema);
  void write(std::uint16_t channel, std::uint64_t time_ns, const std::string& json);
  // Closes the last chunk, writes the summary, gives the file its name.
  [[nodiscard]] Result<> finish();

 private:
  struct IndexEntry {
    std::uint64_t time_ns = 0;
    std::uint64_t offset = 0;
  };
  struct Schema {
    std::string name;
    std::string record;
  };
  explicit McapWriter(PartialFile file, std::size_t chunk_bytes) : file_(std::move(file)), chunk_bytes_(chunk_bytes) {}
  void put(const std::string& bytes);
  void close_chunk();
  [[nodiscard]] std::string statistics() const;
  [[nodiscard]] std::string summary(std::uint64_t start) const;

  PartialFile file_;
  std::size_t chunk_bytes_;
  std::uint64_t position_ = 0;
  std::uint32_t data_crc_ = 0;
  std::vector<Schema> schemas_;
  std::vector<std::string> channels_;  // records, number = index
  std::string chunk_;
  std::map<std::uint16_t, std::vector<IndexEntry>> chunk_index_;
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::vector<std::string> chunk_index_records_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::map<std::uint16_t, std::uint32_t> sequence_;
  std::uint64_t first_ns_ = 0, last_ns_ = 0, messages_ = 0;
};

}  // namespace pelorus
