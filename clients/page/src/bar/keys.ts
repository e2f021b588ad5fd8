// Keys that work wherever the focus is.
import { kStopKey } from "./stop";

export interface KeyActions {
  toggleRun(): void;
  stop(): void;
  help(): void;
}

// In elements that take the key themselves, as a space in a text.
const kTyping = "input, select, textarea, button, summary, [contenteditable]";

export function listenForKeys(actions: KeyActions): void {
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    // Escape first closes what it closes everywhere: a menu, a question, an enlarged picture
    const closes = document.querySelector("dialog[open], details.popover[open], .tile[aria-pressed='true']") !== null;
    if (event.key === kStopKey && !closes && !event.repeat) return actions.stop();
    if (target.closest(kTyping)) return;
    if (event.key === "?") return actions.help();
    if (event.key !== " ") return;
    event.preventDefault();
    if (!event.repeat) actions.toggleRun();
  }, { capture: true }); // before a menu that Escape closes is closed
}
