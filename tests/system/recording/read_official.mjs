// read_official.mjs FILE.mcap ROWS: the official reader reads every message, by the index and from end to end, with checksums.
import {readFileSync} from 'node:fs';
import {open} from 'node:fs/promises';
import {createRequire} from 'node:module';

const require = createRequire(process.env.ASPERITY_NODE_MODULES + '/');
const {McapIndexedReader, McapStreamReader} = require('@mcap/core');
const [file, rows] = [process.argv[2], Number(process.argv[3])];

const handle = await open(file);
const readable = {
  size: async () => BigInt((await handle.stat()).size),
  read: async (offset, length) => {
    const out = new Uint8Array(Number(length));
    await handle.read(out, 0, out.length, Number(offset));
    return out;
  }
};
const indexed = await McapIndexedReader.Initialize({readable});
let byIndex = 0, last = -1n;
for await (const message of indexed.readMessages({validateCrcs: true})) {
  if (message.logTime < last) throw new Error('messages are out of order');
  last = message.logTime;
  ++byIndex;
}
const stream = new McapStreamReader({validateCrcs: true});
stream.append(readFileSync(file));
let byStream = 0;
for (let record; (record = stream.nextRecord());) byStream += record.type === 'Message' ? 1 : 0;
await handle.close();
if (byIndex !== 5 * rows || byStream !== 5 * rows || !stream.done())
  throw new Error(`${byIndex} messages by the index, ${byStream} by the stream, ${5 * rows} expected`);
console.log(`the official reader read ${byIndex} messages twice`);
