import { makeBlock } from "./blocks";
import type { ReportDocument, Section } from "./document";
import { element } from "./dom";
import { makeTabs } from "./tabs";
import { makeThemeSwitch } from "./theme";

/** Facts that stand open; the rest unfolds. */
const openFacts = 5;

function makeFacts(facts: ReportDocument["facts"]): HTMLElement {
  const items = facts.map(({ name, value }) => element("div", {}, element("dt", {}, name), element("dd", {}, value)));
  return element("dl", { class: "facts" }, ...items);
}

function makeHeader(report: ReportDocument): HTMLElement {
  const rest = report.facts.slice(openFacts);
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
    report.facts.length > 0 && makeFacts(report.facts.slice(0, openFacts)),
    rest.length > 0 &&
      element("details", { class: "more-facts" }, element("summary", {}, "How it was measured"), makeFacts(rest)),
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
