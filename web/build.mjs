// Builds src/aircut/export/viewer/viewer.html: page, style and script in one file
// with two marks, which aircut.export.page fills in. The same sources give the same bytes.
import { build } from "esbuild";
import { readFile, writeFile, mkdir } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const target = process.argv[2] ?? join(here, "../src/aircut/export/viewer");

const common = { bundle: true, minify: true, write: false, legalComments: "inline", logLevel: "warning", absWorkingDir: here, charset: "ascii" };
const [script, style] = await Promise.all([
  build({ ...common, entryPoints: ["src/main.ts"], format: "iife", target: "es2022" }),
  build({ ...common, entryPoints: ["src/style.css"], target: "chrome110" }),
]);
const code = script.outputFiles[0].text;
if (/<\/script/i.test(code)) throw new Error("the script would end its own element");
const page = await readFile(join(here, "src/page.html"), "utf8");
const whole = page
  .replace("/*style*/", () => style.outputFiles[0].text.trim())
  .replace("/*script*/", () => code.trim());

const license = await readFile(join(here, "node_modules/three/LICENSE"), "utf8");
const version = JSON.parse(await readFile(join(here, "node_modules/three/package.json"), "utf8")).version;
await mkdir(target, { recursive: true });
await writeFile(join(target, "viewer.html"), whole);
await writeFile(join(target, "LICENSES.txt"), `viewer.html contains three.js ${version} under this license:\n\n${license.trim()}\n`);
