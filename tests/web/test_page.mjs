// The report page in a browser, on synthetic data: node test_page.mjs, with TOILE_WEB_BUILD (where the packages and the
// page were built) and TOILE_WEB_OUT (where screenshots are kept) in the environment. Exit status 77: no browser.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { after, before, describe, it } from "node:test";
import { axeSource, findChromium, launchBrowser, openReport, panelsPainted, viewerDrawn } from "./browser.mjs";
import { fillTemplate, hostileName, makeReport } from "./synthetic_report.mjs";

if (!findChromium()) {
  console.log("skipped: there is no /usr/bin/chromium (Debian package chromium; TOILE_CHROMIUM names another)");
  process.exit(77);
}

const out = process.env.TOILE_WEB_OUT;
mkdirSync(out, { recursive: true });
const template = readFileSync(path.join(process.env.TOILE_WEB_BUILD, "report_page.html"), "utf8");

function writeReport(name, report) {
  const file = path.join(out, name);
  writeFileSync(file, fillTemplate(template, report));
  return file;
}

async function screenshot(page, name) {
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.screenshot({ path: path.join(out, name), fullPage: true });
}

/** The texts of a column of the first table, from the top. */
const columnTexts = (page, column) =>
  page.locator(`#accuracy-table tbody tr > :nth-child(${column})`).allTextContents();

describe("report page", () => {
  let browser, file, page, problems;

  before(async () => {
    file = writeReport("report.html", makeReport({ rows: 1000, embedded: 12 }));
    browser = await launchBrowser();
    const opened = await openReport(browser.context, file);
    ({ page, problems } = opened);
    await viewerDrawn(page);
    console.log(`1,000 samples' figures, 12 embedded: tabs there after ${opened.milliseconds} ms`);
  });
  after(() => browser?.close());

  it("shows title, verdict and facts, and takes hostile names for text", async () => {
    assert.equal(await page.title(), "T-shirt, 1,000 poses: evaluation");
    assert.equal(await page.getByRole("list", { name: "Verdict" }).getByRole("listitem").count(), 4);
    assert.ok((await page.locator(".facts").textContent()).includes(hostileName));
  });

  it("paints every view of the sample", async () => {
    const panels = await panelsPainted(page);
    assert.equal(panels.length, 4);
    for (const panel of panels) {
      assert.ok(panel.colours > 50, `${panel.colours} colours`);
      assert.ok(panel.share > 0.05 && panel.share < 0.9, `${panel.share} of the panel painted`);
    }
    assert.equal(new Set(panels.map((panel) => panel.digest)).size, 4, "each view is another cloth");
    await screenshot(page, "viewer_light.png");
  });

  it("changes the picture with the field, the view angle, the sample, body and layout", async () => {
    const changes = {
      "colour by distance": () => page.getByLabel("Colour by").selectOption("distance"),
      "colour by μ, which all samples share": () => page.getByLabel("Colour by").selectOption("mu"),
      "plain colours": () => page.getByLabel("Colour by").selectOption(""),
      "arrow key": () => page.locator(".stage").press("ArrowLeft"),
      "zoom by key": () => page.locator(".stage").press("+"),
      drag: () =>
        page
          .locator(".stage")
          .dragTo(page.locator(".stage"), { sourcePosition: { x: 100, y: 200 }, targetPosition: { x: 220, y: 230 } }),
      "next sample": () => page.getByRole("button", { name: "Next sample" }).click(),
      "without body": () => page.getByLabel("Body").uncheck(),
      "without ground truth": () => page.getByLabel("ground truth").uncheck(),
      overlay: () => page.getByLabel("Layout").selectOption("overlay"),
    };
    let last = JSON.stringify(await panelsPainted(page));
    for (const [name, change] of Object.entries(changes)) {
      await change();
      await viewerDrawn(page);
      const now = JSON.stringify(await panelsPainted(page));
      assert.notEqual(now, last, name);
      last = now;
    }
    assert.equal(await page.locator(".panel").count(), 1);
    await screenshot(page, "viewer_overlay.png");
    await page.getByLabel("Layout").selectOption("side");
    assert.equal(await page.locator(".panel").count(), 3);
  });

  it("turns back to where it was by the opposite keys", async () => {
    await page.locator(".stage").press("0");
    await viewerDrawn(page);
    const begin = await panelsPainted(page);
    for (const key of ["ArrowUp", "ArrowRight"]) await page.locator(".stage").press(key);
    await viewerDrawn(page);
    assert.notDeepEqual(await panelsPainted(page), begin);
    await page.locator(".stage").press("0");
    await viewerDrawn(page);
    assert.deepEqual(await panelsPainted(page), begin);
  });

  it("offers samples by split, worst first and by number", async () => {
    const list = page.getByLabel("Sample", { exact: true });
    const numbers = async () => (await list.locator("option").allTextContents()).map((text) => parseInt(text));
    await page.getByLabel("Order of the samples").selectOption("error");
    assert.deepEqual((await numbers()).slice(0, 3), [923, 930, 937]);
    await page.getByLabel("Order of the samples").selectOption("number");
    const all = await numbers();
    assert.deepEqual(
      all,
      all.slice().sort((a, b) => a - b),
    );
    await page.getByLabel("Split", { exact: true }).selectOption("test");
    assert.deepEqual(await numbers(), [937, 958, 979, 1000]);
    await list.selectOption({ index: 2 });
    await viewerDrawn(page);
    assert.equal(await page.locator(".images img").first().getAttribute("alt"), "displacement, front of sample 979");
  });

  it("opens tabs by mouse and by keyboard", async () => {
    const tab = (name) => page.getByRole("tab", { name });
    await tab("Accuracy").click();
    assert.ok(await page.locator("#accuracy-table").isVisible());
    assert.ok(!(await page.locator(".stage").isVisible()));
    await page.keyboard.press("ArrowRight");
    assert.equal(await tab("Run time").getAttribute("aria-selected"), "true");
    assert.ok(await page.locator("#runtime-curves").isVisible());
    await page.keyboard.press("ArrowRight");
    assert.equal(await tab("Look").getAttribute("aria-selected"), "true");
    await page.keyboard.press("End");
    assert.equal(await tab("Run time").evaluate((node) => node === document.activeElement), true);
    assert.ok(page.url().endsWith("#runtime"));
  });

  it("sorts tables by mouse and by keyboard, with what is missing last", async () => {
    await page.getByRole("tab", { name: "Accuracy" }).click();
    const header = (name) => page.locator("#accuracy-table").getByRole("button", { name });
    const values = async () => (await columnTexts(page, 3)).map(parseFloat);
    const before = await values();
    await header("sqrt MSE").click();
    const rising = before.slice().sort((a, b) => a - b);
    assert.notDeepEqual(before, rising);
    assert.deepEqual(await values(), rising);
    await header("sqrt MSE").press("Enter");
    assert.deepEqual(await values(), rising.slice().reverse());
    assert.equal(await page.locator("#accuracy-table th[aria-sort]").getAttribute("aria-sort"), "descending");
    for (let press = 0; press < 2; ++press) {
      await header("overstretched").press("Enter");
      assert.deepEqual((await columnTexts(page, 5)).slice(-3), ["–", "–", "–"]);
    }
  });

  it("shows intervals and lists the notes of a table's cells", async () => {
    const cell = page.locator("#accuracy-table td", { hasText: "[8.6, 9.5]" }).first();
    assert.ok(await cell.isVisible());
    assert.deepEqual(await page.locator("#accuracy-table .notes li").allTextContents(), [
      "differs from the prediction by less than the simulator's noise",
    ]);
  });

  it("filters a table of 1,000 rows", async () => {
    await page.getByLabel("Filter the rows of Every sample").fill("quasistatic 99");
    const shown = await page.locator("#sample-table tbody tr:visible").count();
    assert.ok(shown > 0 && shown < 333, `${shown} rows`);
    await page.getByLabel("Filter the rows of Every sample").fill("");
    assert.equal(await page.locator("#sample-table tbody tr:visible").count(), 1000);
    await screenshot(page, "accuracy_light.png");
  });

  it("draws curves whose points name themselves, and hides a series by its legend", async () => {
    await page.getByRole("tab", { name: "Run time" }).click();
    const chart = page.locator("#runtime-curves .chart");
    await chart.locator("svg").waitFor();
    await chart.evaluate((node) => node.scrollIntoView({ block: "center" }));
    const paths = () => chart.locator("svg path").count();
    const before = await paths();
    const lowest = await chart.locator("svg").evaluate((svg) => {
      const marks = [...svg.querySelectorAll("path")].filter((path) => path.getAttribute("fill") === "var(--series-1)");
      const box = marks.at(-1).getBoundingClientRect();
      return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
    });
    await page.mouse.move(lowest.x, lowest.y);
    await page.getByText("inextensibility, tolerance 1e-").waitFor();
    await screenshot(page, "runtime_light.png");
    await page.locator("#runtime-curves").getByRole("button", { name: "inextensibility" }).press("Enter");
    await page.waitForFunction(
      (count) => document.querySelectorAll("#runtime-curves .chart svg path").length < count,
      before,
    );
    assert.ok((await page.locator("#runtime-curves .remark").textContent()).startsWith("One point is not drawn"));
    await page.locator("#runtime-curves summary").press("Enter");
    await page.locator("#runtime-curves tbody").waitFor();
    assert.equal(await page.locator("#runtime-curves tbody tr").count(), 57);
  });

  it("is dark where the system is, and when it is asked to be", async () => {
    const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const light = await paper();
    await page.emulateMedia({ colorScheme: "dark" });
    const dark = await paper();
    assert.notEqual(dark, light);
    await page.getByRole("button", { name: "Light colours" }).click();
    assert.equal(await paper(), light);
    await page.getByRole("button", { name: "Dark colours" }).click();
    assert.equal(await paper(), dark);
    await screenshot(page, "runtime_dark.png");
    await page.getByRole("tab", { name: "Look" }).click();
    await viewerDrawn(page);
    await screenshot(page, "viewer_dark.png");
  });

  it("prints every section, with charts that fit the paper", async () => {
    const pdf = await page.pdf({ path: path.join(out, "report.pdf"), format: "A4", printBackground: false });
    assert.equal(pdf.subarray(0, 5).toString(), "%PDF-");
    await page.emulateMedia({ media: "print" });
    for (const block of ["#viewer", "#accuracy-table", "#accuracy-histogram", "#runtime-curves", "#narrow-curves"]) {
      assert.ok(await page.locator(block).isVisible(), block);
    }
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    const widths = await page
      .locator(".chart svg")
      .evaluateAll((all) => all.map((svg) => svg.getBoundingClientRect().width));
    assert.equal(widths.length, 3);
    for (const width of widths) assert.ok(width > 500 && width <= 688, `${width} px on A4's 688`);
    await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    await page.emulateMedia({ media: "screen" });
  });

  it("fits a small screen", async () => {
    await page.setViewportSize({ width: 390, height: 800 });
    for (const tab of await page.getByRole("tab").all()) {
      await tab.click();
      const width = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(width <= 390, `${await tab.textContent()} is ${width} wide`);
    }
    await page.getByRole("tab", { name: "Look" }).click();
    await viewerDrawn(page);
    await screenshot(page, "viewer_small.png");
  });

  it("said nothing on the console, threw nothing, and asked for no other file", () => assert.deepEqual(problems, []));

  it("has no serious fault of accessibility on any tab, in dark and light", async () => {
    // Few rows: what axe looks at grows with the square of a table's cells, and they are all alike.
    const { page } = await openReport(
      browser.context,
      writeReport("report_small.html", makeReport({ rows: 30, embedded: 2 })),
    );
    await viewerDrawn(page);
    await page.evaluate(axeSource());
    for (let mode = 0; mode < 2; ++mode) {
      for (const tab of await page.getByRole("tab").all()) {
        await tab.click();
        const { violations } = await page.evaluate(() => globalThis.axe.run());
        const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
        const texts = serious.flatMap(({ id, nodes }) =>
          nodes.map((node) => `${id}: ${node.html} ${node.failureSummary}`),
        );
        assert.deepEqual(texts, []);
      }
      await page.locator(".theme-switch").click();
    }
  });

  it("opens a section by its address, and does without a scene", async () => {
    const bare = writeReport("report_without_scene.html", makeReport({ rows: 30, embedded: 0 }));
    const opened = await openReport(browser.context, bare, "#runtime");
    assert.equal(await opened.page.getByRole("tab", { selected: true }).textContent(), "Run time");
    assert.equal(await opened.page.locator(".viewer").count(), 0);
    assert.deepEqual(opened.problems, []);
  });

  it("says so where a sample's blob is missing, and shows the others", async () => {
    const report = makeReport({ rows: 30, embedded: 3 });
    const worst = report.data.scene.samples[2].cloth.target.position.blob;
    report.blobs = report.blobs.filter((script) => !script.includes(`id="${worst}"`));
    const opened = await openReport(browser.context, writeReport("report_without_blob.html", report));
    await opened.page.getByText(/Sample 986 cannot be shown/).waitFor();
    await opened.page.getByRole("button", { name: "Next sample" }).click();
    await viewerDrawn(opened.page);
    assert.equal((await panelsPainted(opened.page)).length, 4);
  });
});
