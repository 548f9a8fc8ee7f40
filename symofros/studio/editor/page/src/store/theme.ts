/** Dark or light: what the system says, unless the user chose. */

import { create } from "zustand";

export type Theme = "light" | "dark";

const STORED = "symofros-theme";
const dark = window.matchMedia("(prefers-color-scheme: dark)");

function initial(): Theme {
  const stored = localStorage.getItem(STORED);
  if (stored === "light" || stored === "dark") return stored;
  return dark.matches ? "dark" : "light";
}

const useThemeStore = create<{ theme: Theme }>(() => ({ theme: initial() }));

function apply(theme: Theme): void {
  useThemeStore.setState({ theme });
  document.documentElement.dataset["theme"] = theme;
}

apply(initial());
dark.addEventListener("change", () => apply(initial()));

export const useTheme = (): Theme => useThemeStore((state) => state.theme);

export function toggleTheme(): void {
  const theme = useThemeStore.getState().theme === "dark" ? "light" : "dark";
  localStorage.setItem(STORED, theme);
  apply(theme);
}
