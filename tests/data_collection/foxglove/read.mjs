// Decode every message of a log with the definitions in the file, and print what a viewer would know of it as JSON.
import { open } from "node:fs/promises";

import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader } from "@mcap/core";
import { FileHandleReadable } from "@mcap/nodejs";
import { loadDecompressHandlers } from "@mcap/support";

const file = await open(process.argv[2], "r");
const reader = await McapIndexedReader.Initialize({
  readable: new FileHandleReadable(file),
  decompressHandlers: await loadDecompressHandlers(),
});
const decoders = new Map();
const counts = {};
const last = {};
const simple = (key, value) =>
  typeof value === "bigint" ? value.toString() : ArrayBuffer.isView(value) ? Array.from(value) : value;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!decoders.has(schema.id)) {
    const definition = new TextDecoder().decode(schema.data);
    decoders.set(schema.id, new MessageReader(parse(definition, { ros2: true })));
  }
  counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
  last[channel.topic] = decoders.get(schema.id).readMessage(message.data);
}
await file.close();
console.log(JSON.stringify({ profile: reader.header.profile, counts, last }, simple));
