// Converts a ROS 1 bag to the recordings of ROS 2, with other people's libraries alone:
//
//   node convert.mjs RECORDING.bag OUTPUT_FOLDER [KB_OF_A_CHUNK]
//
// writes chunked.mcap, zstd.mcap, lz4.mcap, unchunked.mcap, ros1.mcap, recording.db3,
// folder/ (rosbag2, two packed databases and metadata.yaml) and per_message.db3 (each message
// packed). Needs the programs bzip2, zstd, lz4 and sqlite3.

import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

import { Bag } from "@foxglove/rosbag";
import rosbagNode from "@foxglove/rosbag/node.js";
import { parse } from "@foxglove/rosmsg";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import { MessageReader } from "@foxglove/rosmsg-serialization";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { McapWriter } from "@mcap/core";


const CHUNK_BYTES = Number(process.argv[4] ?? 64) * 1024;

// Definitions of a ROS 2 type with all that it is made of, the type itself first.
function definitionsOf(name, seen = new Set()) {
  if (seen.has(name)) return [];
  seen.add(name);
  const own = { name, definitions: ros2humble[name].definitions };
  const parts = own.definitions.filter((field) => field.isComplex);
  return [own, ...parts.flatMap((field) => definitionsOf(field.type, seen))];
}

const ros2Name = (type) => type.replace("/", "/msg/");

function textOf(type) {
  const fields = definitionsOf(type)[0].definitions;
  return fields.map(({ type, isArray, name }) => `${type}${isArray ? "[]" : ""} ${name}\n`).join("");
}

// ROS 1's times are {sec, nsec}, ROS 2's {sec, nanosec}; its headers have no seq.
function toRos2(value) {
  if (Array.isArray(value)) return value.map(toRos2);
  if (value === null || typeof value !== "object" || ArrayBuffer.isView(value)) return value;
  if ("sec" in value && "nsec" in value) return { sec: value.sec, nanosec: value.nsec };
  const entries = Object.entries(value).filter(([key]) => key !== "seq");
  return Object.fromEntries(entries.map(([key, part]) => [key, toRos2(part)]));
}

async function readBag(file) {
  const bag = new Bag(new rosbagNode.FileReader(file), {
    parse: false,
    decompress: { bz2: (data) => run("bzip2", ["-dc"], data) },
  });
  await bag.open();
  const topics = new Map();
  const messages = [];
  for (const connection of bag.connections.values()) {
    if (topics.has(connection.topic)) continue;
    topics.set(connection.topic, {
      name: connection.topic,
      type: connection.type,
      md5sum: connection.md5sum,
      ros1Definition: connection.messageDefinition,
      reader: new MessageReader(parse(connection.messageDefinition)),
      writer: new MessageWriter(definitionsOf(connection.type)),
    });
  }
  for await (const event of bag.messageIterator()) {
    const topic = topics.get(event.topic);
    const ros1 = Uint8Array.from(event.data);
    messages.push({
      topic,
      time: BigInt(event.timestamp.sec) * 1000000000n + BigInt(event.timestamp.nsec),
      ros1,
      cdr: topic.writer.writeMessage(toRos2(topic.reader.readMessage(ros1))),
    });
  }
  return { topics: [...topics.values()], messages };
}

// Feeds a program and returns what it writes.
function run(program, args, input) {
  return execFileSync(program, args, { input, maxBuffer: 1 << 30 });
}

const PACKERS = {
  zstd: (data) => run("zstd", ["-q", "-c"], data),
  lz4: (data) => run("lz4", ["-q", "-c"], data),
};

class FileWritable {
  constructor(file) {
    this.file = fs.openSync(file, "w");
    this.size = 0n;
  }
  async write(bytes) {
    fs.writeSync(this.file, bytes);
    this.size += BigInt(bytes.length);
  }
  position() {
    return this.size;
  }
  close() {
    fs.closeSync(this.file);
  }
}

async function writeMcap(file, recording, { compression = "", chunked = true, ros1 = false }) {
  const writable = new FileWritable(file);
  const writer = new McapWriter({
    writable,
    useChunks: chunked,
    chunkSize: CHUNK_BYTES,
    compressChunk: compression
      ? (data) => ({ compression, compressedData: PACKERS[compression](data) })
      : undefined,
  });
  await writer.start({ profile: ros1 ? "ros1" : "ros2", library: "plumbline test" });
  const channels = new Map();
  for (const topic of recording.topics) {
    const text = ros1 ? topic.ros1Definition : textOf(topic.type);
    const schemaId = await writer.registerSchema({
      name: ros1 ? topic.type : ros2Name(topic.type),
      encoding: ros1 ? "ros1msg" : "ros2msg",
      data: new TextEncoder().encode(text),
    });
    const metadata = new Map(ros1 ? [["md5sum", topic.md5sum]] : []);
    const messageEncoding = ros1 ? "ros1" : "cdr";
    channels.set(
      topic,
      await writer.registerChannel({ schemaId, topic: topic.name, messageEncoding, metadata }),
    );
  }
  let sequence = 0;
  for (const message of recording.messages) {
    await writer.addMessage({
      channelId: channels.get(message.topic),
      sequence: sequence++,
      logTime: message.time,
      publishTime: message.time,
      data: ros1 ? message.ros1 : message.cdr,
    });
  }
  await writer.end();
  writable.close();
}

function writeDatabase(file, recording, messages, pack = (data) => data) {
  fs.rmSync(file, { force: true });
  const quoted = (text) => `'${text.replaceAll("'", "''")}'`;
  const rows = [
    "PRAGMA page_size = 1024;",
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, " +
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);",
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, " +
      "timestamp INTEGER NOT NULL, data BLOB NOT NULL);",
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);",
    "BEGIN;",
  ];
  recording.topics.forEach((topic, i) => {
    rows.push(
      `INSERT INTO topics VALUES(${i + 1}, ${quoted(topic.name)}, ${quoted(ros2Name(topic.type))}, ` +
        "'cdr', '');",
    );
  });
  for (const message of messages) {
    const id = recording.topics.indexOf(message.topic) + 1;
    const data = Buffer.from(pack(message.cdr)).toString("hex");
    rows.push(
      "INSERT INTO messages (topic_id, timestamp, data) " +
        `VALUES(${id}, ${message.time}, X'${data}');`,
    );
  }
  rows.push("COMMIT;");
  run("sqlite3", [file], rows.join("\n"));
}

// As `ros2 bag record --max-bag-size ... --compression-mode file` leaves it.
function writeFolder(folder, recording) {
  fs.mkdirSync(folder, { recursive: true });
  const half = Math.floor(recording.messages.length / 2);
  const parts = [recording.messages.slice(0, half), recording.messages.slice(half)];
  const names = parts.map((messages, i) => {
    const name = `recording_${i}.db3`;
    const file = path.join(folder, name);
    writeDatabase(file, recording, messages);
    run("zstd", ["-q", "-f", "--rm", file]);
    return `${name}.zstd`;
  });
  names.forEach((name) => fs.renameSync(path.join(folder, name.replace("zstd", "zst")),
                                        path.join(folder, name)));
  const metadata = [
    "rosbag2_bagfile_information:",
    "  version: 5",
    "  storage_identifier: sqlite3",
    "  duration:",
    "    nanoseconds: 1",
    "  message_count: " + recording.messages.length,
    "  compression_format: zstd",
    "  compression_mode: FILE",
    "  relative_file_paths:",
    ...names.map((name) => `    - ${name}`),
  ];
  fs.writeFileSync(path.join(folder, "metadata.yaml"), metadata.join("\n") + "\n");
}

const [bag, output] = process.argv.slice(2);
if (bag === undefined || output === undefined) {
  console.error("usage: node convert.mjs RECORDING.bag OUTPUT_FOLDER [KB_OF_A_CHUNK]");
  process.exit(2);
}
const recording = await readBag(bag);
fs.mkdirSync(output, { recursive: true });
const at = (name) => path.join(output, name);
await writeMcap(at("chunked.mcap"), recording, {});
await writeMcap(at("zstd.mcap"), recording, { compression: "zstd" });
await writeMcap(at("lz4.mcap"), recording, { compression: "lz4" });
await writeMcap(at("unchunked.mcap"), recording, { chunked: false });
await writeMcap(at("ros1.mcap"), recording, { ros1: true, compression: "zstd" });
writeDatabase(at("recording.db3"), recording, recording.messages);
writeDatabase(at("per_message.db3"), recording, recording.messages, PACKERS.zstd);
writeFolder(at("folder"), recording);
