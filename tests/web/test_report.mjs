// What the C++ program writes, in a browser: node test_report.mjs, with the environment of test_page.mjs and
// real_report.html (of test_report_for_browser) in TOILE_WEB_OUT.
import assert from "node:assert/strict";
import path from "node:path";
import { after, before, describe, it } from "node:test";
import { findChromium, launchBrowser, openReport, panelsPainted, viewerDrawn } from "./browser.mjs";

if (!findChromium()) {
  console.log("skipped: there is no /usr/bin/chromium (Debian package chromium; TOILE_CHROMIUM names another)");
  process.exit(77);
}

const out = process.env.TOILE_WEB_OUT;

describe("report of the program", () => {
  let browser, page, problems, data;

  before(async () => {
    browser = await launchBrowser();
    ({ page, problems } = await openReport(browser.context, path.join(out, "real_report.html")));
    data = JSON.parse(await page.locator("#data").textContent());
  });
  after(() => browser?.close());

  it("shows every section and block that the program wrote", async () => {
    const tabs = page.getByRole("tab");
    assert.deepEqual(
      await tabs.allTextContents(),
      data.sections.map((section) => section.title),
    );
    for (const [index, section] of data.sections.entries()) {
      await tabs.nth(index).click();
      for (const block of section.blocks) assert.ok(await page.locator(`[id="${block.id}"]`).isVisible(), block.id);
      await page.screenshot({ path: path.join(out, `real_report_${section.id}.png`), fullPage: true });
    }
  });

  it("has as many rows in each table", async () => {
    for (const block of data.sections.flatMap((section) => section.blocks)) {
      if (block.type !== "table") continue;
      assert.equal(await page.locator(`[id="${block.id}"] tbody tr`).count(), block.rows.length, block.id);
    }
  });

  it("paints each view of each sample", async () => {
    const section = data.sections.findIndex(({ blocks }) => blocks.some((block) => block.type === "viewer"));
    await page.getByRole("tab").nth(section).click();
    for (const _ of data.scene.samples) {
      await viewerDrawn(page);
      const panels = await panelsPainted(page);
      const drawn = Number(await page.locator(".stage").getAttribute("data-drawn"));
      const sample = data.scene.samples.find(({ id }) => id === drawn);
      assert.equal(panels.length, Object.keys(sample.cloth).length); // a prior that failed has no cloth to show
      for (const panel of panels) assert.ok(panel.colours > 1 && panel.share > 0, JSON.stringify(panel));
      await page.getByRole("button", { name: "Next sample" }).click();
    }
  });

  it("said nothing on the console, threw nothing, and asked for no other file", () => assert.deepEqual(problems, []));
});
