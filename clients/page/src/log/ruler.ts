// A ruler of simulated time with a mark for each event: of the last while, or of a whole recording.
import { EventLevel } from "../link/messages";
import type { Happening } from "../model/events";
import { h, setText } from "../ui/dom";
import { formatTime } from "../ui/numbers";
import { groupOf } from "./groups";

const kMostMarks = 300;

// The stretch of time on the ruler, and where "now" is in it, as a share.
export interface Stretch {
  from: string;
  to: string;
  now: number;
  place(event: Happening): number; // as a share; outside of 0 to 1 it is not shown
}

export class Ruler {
  readonly element = h("div", { class: "ruler", role: "group", "aria-label": "Events by their time" });
  private readonly marks = h("div", { class: "ruler-marks" });
  private readonly now = h("span", { class: "ruler-now" });
  private readonly ends = [h("span", {}), h("span", {})] as const;

  constructor(private readonly chosen: (event: Happening) => void) {
    this.element.append(h("div", { class: "ruler-track" }, this.marks, this.now), h("div", { class: "ruler-ends" }, ...this.ends));
  }

  show(events: readonly Happening[], stretch: Stretch): void {
    const placed = events.map((event) => ({ event, at: stretch.place(event) })).filter(({ at }) => at >= 0 && at <= 1).slice(-kMostMarks);
    while (this.marks.children.length > placed.length) this.marks.lastElementChild!.remove();
    // The list beside it is there for keys: hundreds of marks would be hundreds of stops
    while (this.marks.children.length < placed.length) this.marks.append(h("button", { type: "button", class: "mark", tabindex: -1 }));
    placed.forEach(({ event, at }, i) => {
      const mark = this.marks.children[i] as HTMLButtonElement;
      mark.style.left = `${(100 * at).toFixed(3)}%`;
      if (mark.dataset["event"] === String(event.number)) return;
      Object.assign(mark.dataset, { event: event.number, level: levelName(event.level), group: groupOf(event.kind, event.text) });
      mark.title = `${formatTime(event.timeS)} ${event.kind}: ${event.text}`;
      mark.setAttribute("aria-label", mark.title);
      mark.onclick = () => this.chosen(event);
    });
    this.now.style.left = `${(100 * stretch.now).toFixed(3)}%`;
    setText(this.ends[0], stretch.from);
    setText(this.ends[1], stretch.to);
  }
}

export const levelName = (level: EventLevel): string => EventLevel[level].toLowerCase();
