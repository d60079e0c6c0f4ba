// node validate.mjs MODEL.glb: Khronos' glTF validator on one file. Every message fails, but for what it has to say of an
// extensions it does not know: that it does not, and that it sees no use of the buffer views to which only that refers.
import {readFile} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {argv, exit} from 'node:process';

const validator = createRequire(import.meta.url)('gltf-validator');
const extension = 'ASPERITY_mesh_haptic_texture';
const unknown = [extension, 'KHR_physics_rigid_bodies', 'ASPERITY_haptic_material'];

async function validate(bytes) {
  const {issues} = await validator.validateBytes(new Uint8Array(bytes), {maxIssues: 100});
  return issues;
}

function documentOf(bytes) {
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
}

// JSON pointers to the buffer views, and to the image of materials, that the extension's object names.
function partsOfExtension(document) {
  const {meshVertices, texture, pieces, field, materials} = document.meshes[0].extensions[extension];
  const views = [meshVertices.bufferView, texture.bufferView, pieces.table, pieces.vertices, pieces.hull, pieces.triangles];
  if (field) views.push(field.bufferView);
  return new Set([...views.map((v) => `/bufferViews/${v}`), ...(materials ? [`/images/${materials.image}`] : [])]);
}

// Negative control: an index that points past the vertices has to be found.
function withBadIndex(bytes) {
  const copy = Buffer.from(bytes);
  const jsonLength = copy.readUInt32LE(12);
  const document = documentOf(copy);
  const {indices} = document.meshes[0].primitives[0];
  const view = document.bufferViews[document.accessors[indices].bufferView];
  copy.writeUInt32LE(0x7fffffff, 20 + jsonLength + 8 + (view.byteOffset ?? 0));
  return copy;
}

const bytes = await readFile(argv[2]);
const {messages, numErrors, numWarnings, numInfos, numHints} = await validate(bytes);
const ours = partsOfExtension(documentOf(bytes));
const isAboutExtension = (m) => (m.code === 'UNSUPPORTED_EXTENSION' && unknown.some((name) => m.message.includes(name))) ||
                                (m.code === 'UNUSED_OBJECT' && ours.has(m.pointer));
const unexpected = messages.filter((m) => !isAboutExtension(m));
for (const m of unexpected) console.log(`  ${m.code} at ${m.pointer ?? `byte ${m.offset}`}: ${m.message}`);
console.log(`validator ${validator.version()}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} information, ` +
            `${numHints} hints; ${messages.length - unexpected.length} about the extension`);

const control = await validate(withBadIndex(bytes));
console.log(`  control, one index changed: ${control.numErrors} errors`);
if (control.numErrors === 0) console.log('  FAILED: the validator does not see a broken index');
if (unexpected.length > 0) console.log('  FAILED: only words about the extension are expected');
exit(unexpected.length > 0 || control.numErrors === 0 ? 1 : 0);
