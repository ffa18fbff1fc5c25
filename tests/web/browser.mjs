// A headless Chromium that opens a report from disk, and what goes wrong while it does.
import { createRequire } from "node:module";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

// The packages of evaluate/web/package-lock.json are in the build tree.
const require = createRequire(path.join(process.env.TOILE_WEB_BUILD, "package.json"));
const { chromium } = require("playwright-core");

export const axeSource = () => require("axe-core").source;

/** Of the environment, or where Debian puts it; null where there is none. */
export function findChromium() {
  const places = [process.env.TOILE_CHROMIUM, "/usr/bin/chromium"];
  return places.find((place) => place && existsSync(place)) ?? null;
}

const switches = [
  "--no-sandbox",
  "--use-angle=swiftshader", // WebGL 2 in software
  "--enable-unsafe-swiftshader",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

/** A browser with a user folder of its own, which goes with it. */
export async function launchBrowser() {
  const folder = mkdtempSync(path.join(os.tmpdir(), "toile-chromium-"));
  const context = await chromium.launchPersistentContext(folder, {
    executablePath: findChromium(),
    headless: true,
    args: switches,
    viewport: { width: 1280, height: 900 },
  });
  context.setDefaultTimeout(120_000);
  const close = async () => {
    await context.close();
    rmSync(folder, { recursive: true, force: true });
  };
  return { context, close };
}

/** Opens a report; `problems` gathers console errors, exceptions, and requests for anything but the file itself. */
export async function openReport(context, file, fragment = "") {
  const page = await context.newPage();
  const address = pathToFileURL(file).href;
  const problems = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) problems.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(`exception: ${error.message}`));
  page.on("request", (request) => {
    const url = request.url().split("#")[0];
    if (url !== address && !url.startsWith("data:")) problems.push(`request: ${url}`);
  });
  const begin = Date.now();
  await page.goto(address + fragment);
  await page.getByRole("tab").first().waitFor();
  return { page, problems, milliseconds: Date.now() - begin };
}

/** Waits until the viewer has drawn its sample, and for the frame in which it is seen. */
export async function viewerDrawn(page) {
  const stage = page.locator(".stage");
  await stage.waitFor();
  await page.waitForFunction(() => document.querySelector(".stage[data-drawn]:not([aria-busy])") !== null);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

/** Of each panel of the 3D view: how many colours it shows, which share of it is painted, and a digest of its pixels. */
export function panelsPainted(page) {
  return page.evaluate(() => {
    const canvas = document.querySelector(".stage canvas");
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const scale = canvas.width / canvas.clientWidth;
    return [...document.querySelectorAll(".panel")].map((panel) => {
      const area = [panel.offsetLeft, panel.offsetTop, panel.offsetWidth, panel.offsetHeight];
      const { data } = copy.getImageData(...area.map((edge) => Math.round(edge * scale)));
      const colours = new Set();
      let painted = 0;
      let digest = 0;
      for (let at = 0; at < data.length; at += 4) {
        const colour = (data[at] << 16) | (data[at + 1] << 8) | data[at + 2];
        digest = (Math.imul(digest, 31) + colour) | 0;
        if (data[at + 3] === 0) continue;
        colours.add(colour);
        ++painted;
      }
      return { colours: colours.size, share: (4 * painted) / data.length, digest };
    });
  });
}
