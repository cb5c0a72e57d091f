// Bundles the libraries of the page into the folder that is named: `node build.mjs .` (after `npm ci --ignore-scripts`).
// The same versions give the same bytes: no times, no paths, no names of machines; check.sh compares them with what is committed.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { readFileSync, statSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const into = resolve(process.argv[2] ?? here);

for (const name of ["echarts", "three"]) {
  const outfile = join(into, `${name}.js`);
  await build({
    absWorkingDir: here,
    entryPoints: [`${name}.entry.mjs`],
    outfile,
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    charset: "utf8",
    legalComments: "eof",
    define: { "process.env.NODE_ENV": '"production"' },
    logLevel: "warning",
  });
  const hash = createHash("sha256").update(readFileSync(outfile)).digest("hex");
  console.log(`${hash}  ${name}.js  ${statSync(outfile).size}`);
}
