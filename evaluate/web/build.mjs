// Bundles src/ into one HTML template without any reference to another file: node build.mjs [OUT.html]
import { build } from "esbuild";
import { readFile, readdir, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? path.join(here, "report_page.html");

/** The bundled text of an entry point, and the packages that went into it. */
async function bundle(entry) {
  const result = await build({
    absWorkingDir: here,
    entryPoints: [entry],
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    charset: "utf8",
    legalComments: "none", // the licences' full texts are in the page: see licences()
    metafile: true,
    write: false,
    logLevel: "warning",
  });
  const packages = Object.keys(result.metafile.inputs)
    .map((input) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(input)?.[1])
    .filter((name) => name !== undefined);
  return { text: result.outputFiles[0].text, packages };
}

/** Licence and notice of each package in the bundle, as their authors want them passed on. */
async function licences(packages) {
  const texts = [...new Set(packages)].sort().map(async (name) => {
    const folder = path.join(here, "node_modules", name);
    const { version, license } = JSON.parse(await readFile(path.join(folder, "package.json"), "utf8"));
    const files = (await readdir(folder)).filter((file) => /^(licen[cs]e|copying|notice)(\.|$)/i.test(file)).sort();
    if (files.length === 0) throw new Error(`${name} comes without a licence text`);
    const contents = await Promise.all(files.map((file) => readFile(path.join(folder, file), "utf8")));
    return `${name} ${version} (${license})\n\n${contents.join("\n\n").trim()}`;
  });
  return (await Promise.all(texts)).join(`\n\n${"-".repeat(80)}\n\n`);
}

function replaceOnce(text, marker, replacement) {
  const parts = text.split(marker);
  if (parts.length !== 2) throw new Error(`the template should hold ${marker} once, not ${parts.length - 1} times`);
  return parts.join(replacement);
}

function escapeMarkup(text) {
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}

const script = await bundle("src/main.ts");
const style = await bundle("src/page.css");
let page = await readFile(path.join(here, "src/report_page.html"), "utf8");
page = replaceOnce(page, "/* TOILE_STYLE */", style.text);
page = replaceOnce(page, "TOILE_LICENCES", escapeMarkup(await licences(script.packages)));
page = replaceOnce(page, "/* TOILE_SCRIPT */", script.text);
for (const marker of ["<!--TOILE_DATA-->", "<!--TOILE_BLOBS-->"]) replaceOnce(page, marker, "");
if (/<\/script|<!--/i.test(script.text)) throw new Error("the bundle holds text that would end its script element");
await writeFile(out, page);
