// SPDX-License-Identifier: Apache-2.0
// The Khronos validator on glTF files.
// Usage: node validate.mjs FILE...; prints the errors, exits with 1 when there are any
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import validator from 'gltf-validator';

/** The validator's errors of one file, one line each; null in `errors` when it could not read the file at all. */
export async function validate(file) {
  const folder = path.dirname(path.resolve(file));
  const result = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(fs.readFileSync(path.join(folder, decodeURIComponent(uri)))),
  });
  const lines = result.issues.messages.filter((m) => m.severity === 0).map((m) => `${m.code} ${m.pointer ?? ''} ${m.message}`);
  return { errors: result.issues.numErrors, lines, warnings: result.issues.numWarnings, info: result.info };
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  let errors = 0;
  for (const file of process.argv.slice(2)) {
    const result = await validate(file);
    errors += result.errors;
    for (const line of result.lines) console.log(`${file}: ${line}`);
  }
  console.log(`${process.argv.length - 2} files, ${errors} errors`);
  process.exit(errors > 0 || process.argv.length < 3 ? 1 : 0);
}
