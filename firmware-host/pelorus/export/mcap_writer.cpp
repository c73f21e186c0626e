#include "firmware-host/pelorus/export/mcap_writer.h"

#include <zlib.h>

#include <algorithm>
#include <utility>

namespace pelorus {
namespace {

// Opcodes of the specification, section "Records".
enum Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics_record = 0x0B,
  summary_offset = 0x0E,
  data_end = 0x0F
};

const std::string kMagic("\x89MCAP0\r\n", 8);

std::uint32_t crc_of(const std::string& bytes, std::uint32_t before = 0) {
  // zlib's signature wants unsigned bytes.
  return static_cast<std::uint32_t>(::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// The fields of a record, little-endian.
class Fields {
 public:
  template <class Integer>
  Fields& number(Integer value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      bytes_ += static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xFFU);
    }
    return *this;
  }
  Fields& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    return raw(value);
  }
  Fields& raw(const std::string& value) {
    bytes_ += value;
    return *this;
  }
  // A map or an array: its size in bytes, then its entries.
  Fields& list(const Fields& entries) { return text(entries.bytes_); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Opcode opcode, const Fields& fields) {
  return Fields()
      .number(static_cast<std::uint8_t>(opcode))
      .number(static_cast<std::uint64_t>(fields.bytes().size()))
      .raw(fields.bytes())
      .bytes();
}

}  // namespace

Result<McapWriter> McapWriter::create(const std::filesystem::path& path, bool overwrite, std::size_t chunk_bytes) {
  Result<PartialFile> file = PartialFile::create(path, overwrite);
  if (!file) return file.error();
  McapWriter writer(std::move(file.value()), chunk_bytes);
  writer.put(kMagic + record(header, Fields().text("").text("pelorus")));
  return writer;
}

void McapWriter::put(const std::string& bytes) {
  file_.write(bytes);
  data_crc_ = crc_of(bytes, data_crc_);
  position_ += bytes.size();
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& schema_name,
                                      const std::string& json_schema) {
  const auto known =
      std::find_if(schemas_.begin(), schemas_.end(), [&](const Schema& s) { return s.name == schema_name; });
  // Schema numbers start at 1: 0 means that there is none.
  const auto schema_id = static_cast<std::uint16_t>(known - schemas_.begin() + 1);
  if (known == schemas_.end()) {
    Fields fields;
    fields.number(schema_id).text(schema_name).text("jsonschema").text(json_schema);
    schemas_.push_back({schema_name, record(schema, fields)});
    chunk_ += schemas_.back().record;
  }
  const auto id = static_cast<std::uint16_t>(channels_.size());
  channels_.push_back(record(channel, Fields().number(id).number(schema_id).text(topic).text("json").list(Fields())));
  chunk_ += channels_.back();
  return id;
}

void McapWriter::write(std::uint16_t channel_id, std::uint64_t time_ns, const std::string& json) {
  if (chunk_index_.empty()) chunk_first_ns_ = chunk_last_ns_ = time_ns;
  chunk_first_ns_ = std::min(chunk_first_ns_, time_ns);
  chunk_last_ns_ = std::max(chunk_last_ns_, time_ns);
  first_ns_ = messages_ == 0 ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  ++messages_;
  ++counts_[channel_id];
  chunk_index_[channel_id].push_back({time_ns, chunk_.size()});
  Fields fields;
  fields.number(channel_id).number(sequence_[channel_id]++).number(time_ns).number(time_ns).raw(json);
  chunk_ += record(message, fields);
  if (chunk_.size() >= chunk_bytes_) close_chunk();
}

void McapWriter::close_chunk() {
  if (chunk_.empty()) return;
  const std::uint64_t start = position_;
  Fields fields;
  fields.number(chunk_first_ns_).number(chunk_last_ns_).number(std::uint64_t{chunk_.size()});
  fields.number(crc_of(chunk_)).text("").number(std::uint64_t{chunk_.size()}).raw(chunk_);
  put(record(chunk, fields));
  const std::uint64_t length = position_ - start;
  Fields offsets;
  for (auto& [id, entries] : chunk_index_) {
    offsets.number(id).number(position_);
    std::stable_sort(entries.begin(), entries.end(),
                     [](const IndexEntry& a, const IndexEntry& b) { return a.time_ns < b.time_ns; });
    Fields list;
    for (const IndexEntry& entry : entries) list.number(entry.time_ns).number(entry.offset);
    put(record(message_index, Fields().number(id).list(list)));
  }
  Fields index;
  index.number(chunk_first_ns_).number(chunk_last_ns_).number(start).number(length).list(offsets);
  index.number(position_ - start - length).text("").number(std::uint64_t{chunk_.size()});
  chunk_index_records_.push_back(record(chunk_index, index.number(std::uint64_t{chunk_.size()})));
  chunk_.clear();
  chunk_index_.clear();
}

std::string McapWriter::statistics() const {
  Fields counts;
  for (const auto& [id, count] : counts_) counts.number(id).number(count);
  Fields fields;
  fields.number(messages_).number(static_cast<std::uint16_t>(schemas_.size()));
  fields.number(static_cast<std::uint32_t>(channels_.size())).number(std::uint32_t{0}).number(std::uint32_t{0});
  fields.number(static_cast<std::uint32_t>(chunk_index_records_.size()))
      .number(first_ns_)
      .number(last_ns_)
      .list(counts);
  return record(statistics_record, fields);
}

// Groups of records, where each group is, and the footer; `start` is where this begins in the file.
std::string McapWriter::summary(std::uint64_t start) const {
  std::string bytes, offsets;
  const auto group = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    Fields where;
    where.number(static_cast<std::uint8_t>(opcode)).number(start + bytes.size()).number(std::uint64_t{records.size()});
    offsets += record(summary_offset, where);
    bytes += records;
  };
  std::string records;
  for (const Schema& one : schemas_) records += one.record;
  group(schema, records);
  records.clear();
  for (const std::string& one : channels_) records += one;
  group(channel, records);
  group(statistics_record, statistics());
  records.clear();
  for (const std::string& one : chunk_index_records_) records += one;
  group(chunk_index, records);
  const std::uint64_t offsets_start = start + bytes.size();
  bytes += offsets;
  // The checksum covers all from the start of the summary to itself, the head of the footer included.
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  bytes += Fields()
               .number(static_cast<std::uint8_t>(footer))
               .number(kFooterBytes)
               .number(start)
               .number(offsets_start)
               .bytes();
  return bytes + Fields().number(crc_of(bytes)).bytes();
}

Result<> McapWriter::finish() {
  close_chunk();
  put(record(data_end, Fields().number(data_crc_)));
  put(summary(position_));
  file_.write(kMagic);
  return file_.finish();
}

}  // namespace pelorus
