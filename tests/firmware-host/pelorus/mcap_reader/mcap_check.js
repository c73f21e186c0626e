// Judges an MCAP file of `pelorus export` with a reader that others wrote, and with the published schemas.
// usage: node mcap_check.js NODE_MODULES FILE.mcap RUN. Exit code 0: as it should be, 1: not.
"use strict";
const assert = require("node:assert");
const fs = require("node:fs");
const path = require("node:path");

const [modules, file, run] = process.argv.slice(2);
const load = (name) => require(require.resolve(name, { paths: [modules] }));
const { McapStreamReader, McapIndexedReader } = load("@mcap/core");
const { crc32 } = load("@foxglove/crc");
const published = load("@foxglove/schemas/jsonschema");

// A value against a JSON Schema: types, and neither fields too few nor too many.
function conform(schema, value, where) {
  const types = {
    object: () => typeof value === "object" && value !== null && !Array.isArray(value),
    array: () => Array.isArray(value),
    string: () => typeof value === "string",
    boolean: () => typeof value === "boolean",
    number: () => typeof value === "number",
    integer: () => Number.isInteger(value),
  };
  if (schema.type) assert(types[schema.type](), `${where} is no ${schema.type}: ${JSON.stringify(value)}`);
  if (schema.oneOf) assert(schema.oneOf.some((one) => one.const === value), `${where}: ${value} is none of the values`);
  if (schema.type === "array") value.forEach((item, i) => conform(schema.items, item, `${where}[${i}]`));
  if (schema.type !== "object" || !schema.properties) return;
  for (const name of Object.keys(value)) assert(schema.properties[name], `${where}.${name} is not in the schema`);
  for (const [name, type] of Object.entries(schema.properties)) {
    assert(name in value, `${where}.${name} is missing`);
    conform(type, value[name], `${where}.${name}`);
  }
}

// Every record in the order of the file; the reader checks the sums of the chunks.
function stream(bytes) {
  const reader = new McapStreamReader({ includeChunks: true, validateCrcs: true });
  const records = [];
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) records.push(record);
  assert(reader.done(), "the file does not end where it should");
  return records;
}

async function indexed(bytes) {
  return McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
    },
  });
}

function lines(name) {
  return fs.readFileSync(path.join(run, name), "utf8").trim().split("\n").filter((line) => line !== "");
}

function check_messages(messages) {
  const poses = messages.filter((m) => m.schema === "foxglove.PoseInFrame");
  const tum = lines("camera.tum").map((line) => line.split(" "));
  assert.strictEqual(poses.length, tum.length, "poses");
  poses.forEach(({ value, log_time }, i) => {
    const [sec, nsec] = tum[i][0].split(".").map(Number);
    assert.deepStrictEqual(value.timestamp, { sec, nsec });
    assert.strictEqual(log_time, BigInt(sec) * 1000000000n + BigInt(nsec));
    const { position: p, orientation: q } = value.pose;
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w].forEach((x, k) => {
      assert(Math.abs(x - Number(tum[i][k + 1])) < 1e-6, `pose ${i}, number ${k}: ${x} is not ${tum[i][k + 1]}`);
    });
  });
  const rows = lines("objects.csv").slice(1).map((line) => line.split(","));
  const of_bodies = messages.filter((m) => m.value.child_frame_id?.startsWith("body_"));
  assert.strictEqual(of_bodies.length, rows.length, "transforms of bodies");
  of_bodies.forEach(({ value }, i) => {
    assert.strictEqual(value.child_frame_id, `body_${rows[i][1]}`);
    assert(Math.abs(value.translation.x - Number(rows[i][3])) < 1e-6, "translation of a body");
    assert(Math.abs(value.rotation.w - Number(rows[i][6])) < 1e-6, "rotation of a body");
  });
  const boxes = messages.flatMap((m) => (m.schema === "foxglove.SceneUpdate" ? m.value.entities : []));
  assert.strictEqual(boxes.length, rows.filter((row) => row[2] !== "ended").length, "boxes");
  assert.strictEqual(messages.filter((m) => m.schema === "pelorus.Frame").length, lines("frames.csv").length - 1);
}

async function main() {
  const bytes = new Uint8Array(fs.readFileSync(file));
  const records = stream(bytes);
  const chunks = records.filter((r) => r.type === "Chunk");
  assert(chunks.length >= 2, `${chunks.length} chunk(s): too few to judge the index`);
  assert(chunks.every((chunk) => chunk.uncompressedCrc !== 0), "a chunk without a sum");

  // The sum of the data section: all before the record DataEnd (9 bytes of head, 4 of sum).
  const data_end = records.find((r) => r.type === "DataEnd");
  const footer = records.find((r) => r.type === "Footer");
  assert.strictEqual(data_end.dataSectionCrc, crc32(bytes.subarray(0, Number(footer.summaryStart) - 13)), "data sum");
  assert(footer.summaryCrc !== 0 && footer.summaryOffsetStart > footer.summaryStart);

  // By the index, which checks the sum of the summary.
  const reader = await indexed(bytes);
  assert.strictEqual(reader.chunkIndexes.length, chunks.length);
  assert(reader.summaryOffsetsByOpcode.size >= 4, "groups of the summary");
  const messages = [];
  for await (const m of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(m.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    assert.strictEqual(channel.messageEncoding, "json");
    assert.strictEqual(schema.encoding, "jsonschema");
    const value = JSON.parse(new TextDecoder().decode(m.data));
    conform(JSON.parse(new TextDecoder().decode(schema.data)), value, schema.name);
    const [space, type] = schema.name.split(".");
    if (space === "foxglove") conform(published[type], value, `published ${schema.name}`);
    messages.push({ schema: schema.name, value, log_time: m.logTime });
  }
  assert.strictEqual(reader.statistics.messageCount, BigInt(messages.length), "messages by the index");
  assert.strictEqual(records.filter((r) => r.type === "MessageIndex").length > 0, true);
  check_messages(messages);

  // Half of the time, found by the index alone.
  const { messageStartTime: first, messageEndTime: last } = reader.statistics;
  const middle = (first + last) / 2n;
  let later = 0;
  for await (const m of reader.readMessages({ startTime: middle })) later += m.logTime >= middle ? 1 : NaN;
  assert.strictEqual(later, messages.filter((m) => m.log_time >= middle).length, "messages of the second half");

  // A damaged byte is noticed, so that the sums are not for show.
  const damaged = bytes.slice();
  damaged[Math.floor(Number(reader.chunkIndexes[0].chunkStartOffset) + 600)] ^= 1;
  assert.throws(() => stream(damaged), /crc/i);
  console.log(`${messages.length} messages in ${chunks.length} chunks`);
}

main().catch((error) => {
  console.error(error.message);
  process.exit(1);
});
