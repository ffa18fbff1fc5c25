import { makeBlock } from "./blocks";
import type { ReportDocument, Section } from "./document";
import { element } from "./dom";
import { makeTabs } from "./tabs";
import { makeThemeSwitch } from "./theme";

function makeHeader(report: ReportDocument): HTMLElement {
  const facts = report.facts.map(({ name, value }) =>
    element("div", {}, element("dt", {}, name), element("dd", {}, value)),
  );
  return element(
    "header",
    {},
    element("div", { class: "title-line" }, element("h1", {}, report.title), makeThemeSwitch()),
    report.verdict.length > 0 &&
      element(
        "ul",
        { class: "verdict", "aria-label": "Verdict" },
        ...report.verdict.map((line) => element("li", {}, line)),
      ),
    facts.length > 0 && element("dl", { class: "facts" }, ...facts),
  );
}

function makeSection(section: Section, report: ReportDocument): HTMLElement {
  return element(
    "section",
    {},
    element("h2", {}, section.title),
    ...section.text.map((paragraph) => element("p", {}, paragraph)),
    ...section.blocks.map((block) => makeBlock(block, report.scene)),
  );
}

function main(): void {
  const data = document.getElementById("data");
  if (!data) throw new Error("this page holds no data: it is the template that toile fills");
  const report = JSON.parse(data.textContent!) as ReportDocument;
  document.title = report.title;
  const tabs = report.sections.map((section) => ({
    id: section.id,
    title: section.title,
    panel: makeSection(section, report),
  }));
  document.getElementById("report")!.append(makeHeader(report), makeTabs("Sections of the report", tabs));
}

main();
