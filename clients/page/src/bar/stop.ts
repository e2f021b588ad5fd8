// The emergency stop: large, always in sight, and on a key. It presses the emergency stop of every part that
// has one. Any role may do that. A world without such a part is paused instead.
import type { Link } from "../link/link";
import type { Clock } from "../model/clock";
import { h } from "../ui/dom";
import { report, reportError } from "../ui/toasts";
import type { PartStrip } from "./strip";

export const kStopKey = "Escape";

export class StopButton {
  readonly element: HTMLButtonElement;

  constructor(private readonly link: Link, private readonly clock: Clock, private readonly strip: PartStrip) {
    this.element = h("button", { type: "button", class: "stop", title: "Stops all parts at once (Escape)", "aria-keyshortcuts": kStopKey, onclick: () => this.press() }, "Stop");
    const show = () => (this.element.disabled = !link.welcome || link.recorded.value);
    link.state.watch(show);
    link.recorded.watch(show);
  }

  press(): void {
    if (this.element.disabled) return;
    const watches = this.strip.watches.filter(({ hasStop }) => hasStop);
    if (watches.length === 0) {
      if (!this.link.mayChangeWorld) return report("No part here has an emergency stop, and this role may not pause the world", "error");
      report("The world is paused: no part here has an emergency stop");
      this.clock.pause().catch(reportError);
      return;
    }
    for (const watch of watches) watch.press(true).catch(reportError);
    report(`Stopped: ${watches.map(({ part }) => part.name).join(", ")}`);
  }
}
