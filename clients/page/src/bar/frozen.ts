// Tells that the world stands still after a numerical fault: why, where the ticks before it are, and how to
// go on.
import type { Link } from "../link/link";
import type { Clock } from "../model/clock";
import { h, setText } from "../ui/dom";

const kRecording = "; the ticks before it are in "; // server/gateway/published.cc

export function frozenBanner(link: Link, clock: Clock, reset: () => void): HTMLElement {
  const why = h("p", {});
  const recording = h("p", { class: "frozen-recording" });
  const button = h("button", { type: "button", class: "primary", onclick: reset }, "Reset the world");
  const element = h("div", { class: "frozen", role: "alert", hidden: true },
    h("h2", {}, "The world is frozen"), why, recording, button);
  const show = () => {
    const status = clock.status.value;
    element.hidden = !status?.frozen || !link.welcome || link.recorded.value;
    if (element.hidden) return;
    const { reason, file } = splitReason(status?.frozenReason ?? "");
    setText(why, `${reason}. Nothing moves until it is reset.`);
    recording.hidden = file === "";
    setText(recording, `The ticks before it: visum replay --view ${file}`);
    button.disabled = !link.mayChangeWorld;
    button.title = button.disabled ? "This role may not reset the world" : "";
  };
  clock.status.watch(show);
  link.state.watch(show);
  return element;
}

// Pure.
export function splitReason(text: string): { reason: string; file: string } {
  const at = text.indexOf(kRecording);
  return at < 0 ? { reason: text, file: "" } : { reason: text.slice(0, at), file: text.slice(at + kRecording.length) };
}
