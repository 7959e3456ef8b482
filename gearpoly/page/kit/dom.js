// The page's elements, and the look that its reader chose.

/** @type {(id: string) => any} */
export const element = (id) => document.getElementById(id);

// Wires the menu of themes; `repaint` is called whenever the look has changed.
export function themes(repaint) {
  const menu = element("theme");
  menu.addEventListener("change", () => {
    if (menu.value === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = menu.value;
    repaint();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
}
