// Bundles the libraries of the workbench's page, then the scripts of reports with theirs: `node build.mjs` (after `npm ci --ignore-scripts`).
// The same versions give the same bytes: no times, no paths, no names of machines; check.sh compares them with what is committed.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, statSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));

/** @type {[string, string, "esm" | "iife"][]} in an order in which each finds what it is made of */
const BUNDLES = [
  ["echarts.entry.mjs", "../scripts/vendor/echarts.js", "esm"],
  ["three.entry.mjs", "../../workbench/page/vendor/three.js", "esm"],
  // One classic script: modules of one file can't import each other.
  ["../scripts/report/explore.js", "../scripts/report/bundle.js", "iife"],
];

/** A report is passed on by itself: the licences of what it holds go with it. */
function licences() {
  const folder = join(here, "../scripts/vendor/licences");
  const texts = readdirSync(folder).sort().map((name) => `${name}\n\n${readFileSync(join(folder, name), "utf8").trim()}`);
  return `/*\n${texts.join("\n\n").replaceAll("\r", "").replaceAll("\t", " ").replaceAll("*/", "* /")}\n*/`;
}

for (const [entry, made, format] of BUNDLES) {
  const outfile = join(here, made);
  await build({
    absWorkingDir: here,
    entryPoints: [entry],
    outfile,
    bundle: true,
    minify: true,
    format,
    target: "es2022",
    charset: "utf8",
    legalComments: "eof",
    define: { "process.env.NODE_ENV": '"production"' },
    footer: format === "iife" ? { js: licences() } : {},
    logLevel: "warning",
  });
  const hash = createHash("sha256").update(readFileSync(outfile)).digest("hex");
  console.log(`${hash}  ${made}  ${statSync(outfile).size}`);
}
