// node view.mjs MODEL.glb INSPECTED.json BROWSER PICTURE.png: three.js in a headless browser opens the model as an
// ordinary mesh; its triangles and box have to be those that `asperity inspect --json` printed, its picture not empty.
import {spawn} from 'node:child_process';
import {readFile, mkdtemp, rm, writeFile} from 'node:fs/promises';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {dirname, join, normalize} from 'node:path';
import {argv, exit} from 'node:process';
import {fileURLToPath} from 'node:url';

const [, , model, inspected, browser, picture] = argv;
const patience_ms = 120_000;
const here = dirname(fileURLToPath(import.meta.url));
const three = dirname(dirname(createRequire(import.meta.url).resolve('three')));

// Serves the page, the model and three.js to this machine only; resolves with what the page posts.
function serve(found) {
  const server = createServer(async (request, answer) => {
    const path = normalize(new URL(request.url, 'http://localhost').pathname);
    if (request.method === 'POST') {
      let body = '';
      for await (const part of request) body += part;
      answer.end();
      found(JSON.parse(body));
      return;
    }
    const file = path === '/' ? join(here, 'page.html') : path === '/model.glb' ? model : join(three, path.replace(/^\/three\//, ''));
    try {
      const bytes = await readFile(file);
      answer.setHeader('content-type', file.endsWith('.js') ? 'text/javascript' : file.endsWith('.html') ? 'text/html' : 'model/gltf-binary');
      answer.end(bytes);
    } catch {
      answer.writeHead(404).end();
    }
  });
  return new Promise((ready) => server.listen(0, '127.0.0.1', () => ready(server)));
}

async function look() {
  const profile = await mkdtemp(join(tmpdir(), 'asperity-interop-'));
  let child;
  let server;
  try {
    return await new Promise(async (found, failed) => {
      server = await serve(found);
      // No sandbox: containers and root have none to offer, and the only page is ours. SwiftShader draws without a GPU.
      const flags = ['--headless', '--no-sandbox', '--disable-dev-shm-usage', '--use-gl=angle', '--use-angle=swiftshader',
                     '--enable-unsafe-swiftshader', `--user-data-dir=${profile}`, '--no-first-run'];
      child = spawn(browser, [...flags, `http://127.0.0.1:${server.address().port}/`], {stdio: ['ignore', 'ignore', 'pipe']});
      let complaints = '';
      child.stderr.on('data', (text) => (complaints = (complaints + text).slice(-2000)));
      child.on('error', failed);
      child.on('exit', (code) => failed(new Error(`the browser ended with ${code}: ${complaints}`)));
      setTimeout(() => failed(new Error(`no answer from the page within ${patience_ms / 1000} s: ${complaints}`)), patience_ms).unref();
    });
  } finally {
    if (child?.exitCode === null) {
      const gone = new Promise((done) => child.once('exit', done));
      child.removeAllListeners('exit');
      child.once('exit', () => {});
      child.kill('SIGKILL');
      await Promise.race([gone, new Promise((done) => setTimeout(done, 2000).unref())]);
    }
    server?.closeAllConnections();
    server?.close();
    await rm(profile, {recursive: true, force: true, maxRetries: 5});
  }
}

const expected = JSON.parse(await readFile(inspected));
const found = await look().catch((e) => ({failure: e.message}));
if (found.failure) {
  console.log(`three.js FAILED: ${found.failure}`);
  exit(1);
}
await writeFile(picture, Buffer.from(found.picture.split(',')[1], 'base64'));

const faults = [];
const expect = (good, what) => good || faults.push(what);
const step = 1e-6 * expected.size.diagonal;
const same = (a, b) => a.every((x, i) => Math.abs(x - b[i]) <= step);
expect(found.triangles === expected.coarse.triangles, `${expected.coarse.triangles} triangles were written`);
expect(found.textured === 1, 'the mesh shows no picture');
expect(same(found.low, expected.size.low) && same(found.high, expected.size.high),
       `the box written is ${expected.size.low} to ${expected.size.high}`);
expect(found.covered > 0.02 && found.colours > 50, 'the picture is empty or of one colour');
expect(found.hidden === 0, 'the picture is not empty where the model is hidden: the test cannot see');
const metres = (p) => p.map((x) => x.toPrecision(6)).join(' ');
console.log(`three.js r${found.three}: ${found.triangles} triangles, box ${metres(found.low)} to ${metres(found.high)} m, ` +
            `${(100 * found.covered).toFixed(1)} % of the picture covered in ${found.colours} colours`);
console.log(`  control, model hidden: ${(100 * found.hidden).toFixed(1)} % covered`);
console.log(`  picture: ${picture}`);
for (const f of faults) console.log(`  FAILED: ${f}`);
exit(faults.length > 0 ? 1 : 0);
