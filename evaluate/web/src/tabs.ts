import { element } from "./dom";

export interface Tab {
  id: string;
  title: string;
  panel: HTMLElement;
}

/**
 * Tabs after the WAI-ARIA pattern: arrows, Home and End move, the address keeps the open one. Panels that are not open
 * stay searchable (`hidden="until-found"`): the browser's search opens the tab that holds what it found.
 */
export function makeTabs(label: string, tabs: Tab[]): HTMLElement {
  const list = element("div", { role: "tablist", "aria-label": label, class: "tabs" });
  const buttons = tabs.map((tab) => {
    const button = element(
      "button",
      { type: "button", role: "tab", id: `tab-${tab.id}`, "aria-controls": `panel-${tab.id}` },
      tab.title,
    );
    tab.panel.id = `panel-${tab.id}`;
    tab.panel.setAttribute("role", "tabpanel");
    tab.panel.setAttribute("aria-labelledby", button.id);
    tab.panel.tabIndex = 0;
    return button;
  });

  const select = (chosen: number) => {
    tabs.forEach((tab, index) => {
      const open = index === chosen;
      buttons[index]!.setAttribute("aria-selected", String(open));
      buttons[index]!.tabIndex = open ? 0 : -1;
      if (open) tab.panel.removeAttribute("hidden");
      else tab.panel.setAttribute("hidden", "until-found");
    });
  };
  const open = (chosen: number) => {
    select(chosen);
    buttons[chosen]!.focus();
    buttons[chosen]!.scrollIntoView({ block: "nearest", inline: "nearest" });
    history.replaceState(null, "", `#${tabs[chosen]!.id}`);
  };

  buttons.forEach((button, index) => button.addEventListener("click", () => open(index)));
  tabs.forEach((tab, index) => tab.panel.addEventListener("beforematch", () => select(index)));
  list.addEventListener("keydown", (event) => {
    const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
    const target = neighbour(event.key, at, tabs.length);
    if (target === null) return;
    event.preventDefault();
    open(target);
  });

  const fromAddress = () => tabs.findIndex((tab) => `#${tab.id}` === decodeURIComponent(location.hash));
  window.addEventListener("hashchange", () => select(Math.max(fromAddress(), 0)));
  select(Math.max(fromAddress(), 0));
  list.append(...buttons);
  return element("div", { class: "tabbed" }, list, ...tabs.map((tab) => tab.panel));
}

function neighbour(key: string, at: number, count: number): number | null {
  switch (key) {
    case "ArrowRight":
      return (at + 1) % count;
    case "ArrowLeft":
      return (at + count - 1) % count;
    case "Home":
      return 0;
    case "End":
      return count - 1;
    default:
      return null;
  }
}
