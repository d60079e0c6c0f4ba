// node unpack.mjs FOLDER: unpacks the browser of @sparticuz/chromium, a static build of Chromium's headless shell with
// SwiftShader, into FOLDER. The package's own program would do it, but asks for a newer Node.js than Debian 12 has.
import {execFileSync} from 'node:child_process';
import {chmod, mkdir, readFile, rename, writeFile} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {argv} from 'node:process';
import {promisify} from 'node:util';
import {brotliDecompress} from 'node:zlib';

const folder = argv[2];
const packed = join(dirname(dirname(createRequire(import.meta.url).resolve('@sparticuz/chromium'))), 'bin');
const open = async (name) => promisify(brotliDecompress)(await readFile(join(packed, name)));

await mkdir(folder, {recursive: true});
for (const name of ['swiftshader', 'fonts', 'al2023']) {
  execFileSync('tar', ['-xf', '-', '-C', folder], {input: await open(`${name}.tar.br`)});
}
// Last, and under its own name only when whole: a later run takes its presence for success.
const part = join(folder, 'chromium.part');
await writeFile(part, await open('chromium.br'));
await chmod(part, 0o755);
await rename(part, join(folder, 'chromium'));
