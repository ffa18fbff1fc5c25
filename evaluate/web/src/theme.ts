import { element } from "./dom";

const storageKey = "toile-theme";

/** The switch between light and dark. Until it is used the page follows the system. */
export function makeThemeSwitch(): HTMLElement {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const button = element("button", { type: "button", class: "theme-switch" });
  let chosen = remembered();

  const isDark = () => (chosen ? chosen === "dark" : system.matches);
  const apply = () => {
    if (chosen) document.documentElement.dataset.theme = chosen;
    button.textContent = isDark() ? "Light colours" : "Dark colours";
  };
  button.addEventListener("click", () => {
    chosen = isDark() ? "light" : "dark";
    remember(chosen);
    apply();
  });
  system.addEventListener("change", apply);
  apply();
  return button;
}

// A browser may refuse storage to pages that are opened as files: then the choice lasts as long as the page.
function remembered(): string | null {
  try {
    return localStorage.getItem(storageKey);
  } catch {
    return null;
  }
}

function remember(theme: string): void {
  try {
    localStorage.setItem(storageKey, theme);
  } catch {
    return;
  }
}
