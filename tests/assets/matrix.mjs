// SPDX-License-Identifier: Apache-2.0
// Converts every sample file and judges what comes out: exit code, the Khronos validator, and the rasterised picture
// against ray tracing. Broken files must be refused or read with a warning, and the sentence must name their defect.
// Usage: node matrix.mjs DOMEWARP ASSETS [--filter TEXT] [--size N] [--jobs N] [--variants] [--table FILE.md]
//   --variants: convert to .gltf, compressed in each way, orthographic, and with light in the colours too
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { defectPattern } from './defects.mjs';

const skipped = 77; // what ctest takes for "not run"
const { validate } = await import('./validate.mjs').catch(() => {
  console.log('the Khronos validator is not here: npm ci --prefix tests/assets');
  process.exit(skipped);
});

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    filter: { type: 'string', default: '' },
    size: { type: 'string', default: '512' },
    jobs: { type: 'string', default: '2' },
    table: { type: 'string', default: '' },
    variants: { type: 'boolean', default: false },
  },
});
const [domewarp, assets] = positionals.map((p) => path.resolve(p));
if (!fs.existsSync(path.join(assets, 'manifest.json'))) {
  console.log(`the sample scenes are not here: ${assets}`);
  process.exit(skipped);
}
const work = fs.mkdtempSync(path.join(os.tmpdir(), 'domewarp-matrix-'));
process.on('exit', () => fs.rmSync(work, { recursive: true, force: true }));

const tolerance = 0.5;
const subpixel = 1 / 256; // where the rasteriser snaps vertices to

/** Runs domewarp. A time limit stands for a hang; a signal for a crash. */
function run(args, seconds = 300) {
  return new Promise((resolve) => {
    const started = performance.now();
    const child = spawn(domewarp, args, { stdio: ['ignore', 'pipe', 'pipe'] });
    let stdout = '', stderr = '', hung = false;
    child.stdout.on('data', (data) => (stdout += data));
    child.stderr.on('data', (data) => (stderr += data));
    const timer = setTimeout(() => { hung = true; child.kill('SIGKILL'); }, seconds * 1000);
    child.on('close', (code, signal) => {
      clearTimeout(timer);
      resolve({ code, signal, hung, stdout, stderr, seconds: (performance.now() - started) / 1000 });
    });
  });
}

function isCrash(result) {
  return result.hung || result.signal !== null || ![0, 2, 3].includes(result.code) || /AddressSanitizer|runtime error:/.test(result.stderr);
}

function filesIn(kind) {
  return fs.readdirSync(path.join(assets, kind), { recursive: true })
    .filter((name) => /\.(glb|gltf)$/.test(name))
    .map((name) => path.join(kind, name))
    .filter((name) => name.includes(options.filter))
    .sort();
}

const view = ['--lens', 'equidistant', '--fov', '180', '--size', `${options.size}x${options.size}`, '--json'];

async function convert(file, output, ...more) {
  const result = await run(['convert', path.join(assets, file), '-o', output, ...view, ...more]);
  try { result.report = JSON.parse(result.stdout); } catch { result.report = null; }
  return result;
}

const variants = [
  ['gltf'], ['glb', '--quantize'], ['glb', '--draco'], ['glb', '--meshopt'], ['gltf', '--meshopt', '--quantize'],
  ['glb', '--projection', 'orthographic'], ['glb', '--shading', 'bake', '--shadows'],
];

/** Every other form of the file that must be sound too. The validator cannot look into compressed ones: `inspect` decodes them. */
async function judgeVariants(file, row) {
  for (const [extension, ...flags] of variants) {
    const output = path.join(row.folder, `variant${flags.join('')}.${extension}`);
    const say = (problem) => row.problems.push(`${flags.join(' ')} ${extension}: ${problem}`);
    const result = await convert(file, output, ...flags);
    if (isCrash(result) || result.code === 2) {
      say(`exit ${result.code} ${result.stderr.trim()}`);
      continue;
    }
    const checked = await validate(output);
    checked.lines.forEach(say);
    const inspected = await run(['inspect', output, '--json']);
    let audit;
    try { audit = JSON.parse(inspected.stdout); } catch { say(`inspect: exit ${inspected.code} ${inspected.stderr.trim()}`); continue; }
    if (audit.cracks.torn_positions > 0) say(`${audit.cracks.torn_positions} torn positions once decoded`);
  }
}

/** `scenes`, `features`, `odd`: converts, valid, the same picture. */
async function judgeGood(file, row) {
  const output = path.join(row.folder, 'out.glb');
  const result = await convert(file, output, '--source-attributes');
  row.code = result.code;
  row.said = result.stderr.trim();
  if (isCrash(result)) return row.problems.push(result.hung ? 'hangs' : `crashes: ${result.signal ?? result.code} ${result.stderr}`);
  if (result.code === 2) {
    if (!/extensionsRequired/.test(result.stderr)) row.problems.push(`refused: ${result.stderr.trim()}`);
    row.verdict = 'refused for a required extension';
    return;
  }
  row.triangles = result.report.triangles.output;
  row.certified = result.report.error_px.max;
  if (result.code !== 0) row.problems.push(`exit ${result.code}: ${result.stderr.trim()}`);
  const checked = await validate(output);
  row.problems.push(...checked.lines);
  row.validator = checked.errors;
  if (row.triangles > 0) await judgePicture(file, output, row);
  if (options.variants) await judgeVariants(file, row);
}

async function judgePicture(file, output, row) {
  const compared = await run(['compare', path.join(assets, file), output, '--json']);
  let judged;
  try { judged = JSON.parse(compared.stdout); } catch { return row.problems.push(`compare: exit ${compared.code} ${compared.stderr.trim()}`); }
  row.displacement = judged.displacement_px?.max ?? null;
  row.pinholes = judged.pinholes;
  row.mismatch = judged.surface_mismatch;
  if (judged.pinholes > 0) row.problems.push(`${judged.pinholes} pinholes`);
  if (row.displacement > tolerance + subpixel) row.problems.push(`displacement ${row.displacement} px`);
}

/** `bad`: refused, or read with a warning, by the name of the defect; and what is written all the same is sound. */
async function judgeBad(file, row, code) {
  const output = path.join(row.folder, 'out.glb');
  const result = await convert(file, output);
  row.code = result.code;
  row.said = result.stderr.trim().replaceAll(assets + path.sep, '');
  if (isCrash(result)) return row.problems.push(result.hung ? 'hangs' : `crashes: ${result.signal ?? result.code}`);
  if (row.said === '') row.problems.push('read without a word');
  const pattern = defectPattern(code);
  if (!pattern) row.problems.push(`no sentence is expected for ${code}`);
  else if (!pattern.test(row.said)) row.problems.push(`does not name ${code}`);
  if (result.code === 2) {
    if (fs.existsSync(output)) row.problems.push('wrote a file all the same');
    return;
  }
  const checked = await validate(output);
  row.problems.push(...checked.lines);
  row.validator = checked.errors;
}

const manifest = JSON.parse(fs.readFileSync(path.join(assets, 'manifest.json')));
const firstError = new Map(manifest.files.map((entry) => [entry.file, entry.validator.error_codes[0]]));
const rows = ['scenes', 'features', 'odd', 'bad'].flatMap((kind) => filesIn(kind).map((file) => ({ kind, file, problems: [] })));

let next = 0, done = 0;
async function worker() {
  while (next < rows.length) {
    const row = rows[next++];
    row.folder = fs.mkdtempSync(path.join(work, 'file-'));
    if (row.kind === 'bad') await judgeBad(row.file, row, firstError.get(row.file));
    else await judgeGood(row.file, row);
    fs.rmSync(row.folder, { recursive: true, force: true });
    if (process.stderr.isTTY) process.stderr.write(`\r${++done} of ${rows.length}`);
  }
}
await Promise.all(Array.from({ length: Number(options.jobs) }, worker));

const number = (value, digits) => (value === undefined || value === null ? '' : Number(value).toFixed(digits));
const lines = ['| file | exit | triangles | validator errors | displacement px | pinholes | remarks |', '|---|---|---|---|---|---|---|'];
for (const row of rows) {
  const remarks = [...row.problems.map((problem) => `**${problem}**`), row.verdict ?? '', (row.said ?? '').split('\n').slice(0, 3).join('; ')];
  lines.push(`| ${row.file} | ${row.code} | ${row.triangles ?? ''} | ${row.validator ?? ''} | ${number(row.displacement, 3)} | ${row.pinholes ?? ''} | ${remarks.filter(Boolean).join(' ').replaceAll('|', '/').slice(0, 400)} |`);
}
if (options.table) fs.writeFileSync(options.table, lines.join('\n') + '\n');
const failed = rows.filter((row) => row.problems.length > 0);
for (const row of failed) console.log(`FAILED ${row.file}: ${row.problems.slice(0, 5).join('; ').slice(0, 600)}${row.said ? `\n    said: ${row.said.split('\n')[0].slice(0, 200)}` : ''}`);
console.log(`${rows.length} files, ${failed.length} failed`);
process.exit(failed.length > 0 || rows.length === 0 ? 1 : 0);
