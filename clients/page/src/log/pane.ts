// The pane "Log": what happened, as lines that can be filtered and as marks on a ruler. A click on either
// shows the other; in a recording it also goes there.
import { EventLevel } from "../link/messages";
import type { Events, Happening } from "../model/events";
import type { Recording } from "../model/recording";
import type { World } from "../model/world";
import { h } from "../ui/dom";
import { formatTime } from "../ui/numbers";
import { reportError } from "../ui/toasts";
import { kGroupNames, matches } from "./groups";
import { levelName, Ruler, type Stretch } from "./ruler";

const kMostLines = 500; // older ones are on the ruler only
const kRefreshMs = 250;
const kSpans: [string, number][] = [["30 s", 30], ["2 min", 120], ["10 min", 600], ["1 h", 3600]];
const kLevels = [["info", EventLevel.INFO], ["warning", EventLevel.WARNING], ["error", EventLevel.ERROR]] as const;

export class LogPane {
  private readonly lines = h("div", { class: "log-lines", role: "listbox", tabindex: 0, "aria-label": "What happened" });
  private readonly empty = h("p", { class: "empty", hidden: true }, "Nothing that matches has happened.");
  private readonly ruler = new Ruler((event) => this.choose(event));
  private readonly search = h("input", { type: "search", placeholder: "Search the log", "aria-label": "Search the log" });
  private readonly group = h("select", { "aria-label": "Kind of event" }, h("option", { value: "" }, "all kinds"), ...kGroupNames.map((name) => h("option", { value: name }, name)));
  private readonly level = h("select", { "aria-label": "Least level" }, ...kLevels.map(([name, value]) => h("option", { value }, name)));
  private readonly span = h("select", { "aria-label": "Length of the ruler" }, ...kSpans.map(([name, value]) => h("option", { value, selected: value === 120 }, name)));
  private dirty = true;
  private shown: Happening[] = []; // all that match
  private chosen = -1; // its number

  constructor(private readonly pane: HTMLElement, private readonly events: Events, private readonly world: World, private readonly recording: Recording) {
    pane.append(h("div", { class: "log-tools" }, this.search, this.group, this.level, this.span), this.ruler.element, this.empty, this.lines);
    const changed = () => (this.dirty = true);
    for (const control of [this.search, this.group, this.level]) control.addEventListener("input", changed);
    events.happened.on(changed);
    events.cleared.on(changed);
    this.lines.addEventListener("keydown", (event) => this.onKey(event));
    setInterval(() => this.refresh(), kRefreshMs);
  }

  private refresh(): void {
    if (document.hidden || this.pane.offsetParent === null) return;
    const report = this.recording.report.value;
    this.span.hidden = report !== null;
    const filter = { words: this.search.value, group: this.group.value, level: Number(this.level.value) };
    if (this.dirty) this.shown = this.events.list.filter((event) => matches(event, filter));
    this.ruler.show(this.shown, report ? this.ofRecording(report.ticks, report.tick_ns) : this.ofLastWhile());
    if (this.dirty) this.showLines();
    this.dirty = false;
  }

  // Times before a reset belong to another time.
  private ofLastWhile(): Stretch {
    const span = Number(this.span.value);
    const { sample } = this.world;
    const now = Number(sample?.simTimeNs ?? 0n) / 1e9;
    const from = Math.max(0, now - span);
    return {
      from: formatTime(from), to: formatTime(from + span), now: (now - from) / span,
      place: ({ era, timeS }) => (era === sample?.era ? (timeS - from) / span : -1),
    };
  }

  private ofRecording(ticks: number, tickNs: number): Stretch {
    const all = Math.max(1, ticks);
    return {
      from: formatTime(0), to: formatTime((ticks * tickNs) / 1e9), now: this.recording.position.value / all,
      place: ({ position }) => (position ?? -1) / all,
    };
  }

  private showLines(): void {
    const atEnd = this.lines.scrollTop + this.lines.clientHeight >= this.lines.scrollHeight - 4;
    this.lines.replaceChildren(...this.shown.slice(-kMostLines).map((event) => this.line(event)));
    this.empty.hidden = this.shown.length > 0;
    this.lines.hidden = this.shown.length === 0;
    this.mark();
    if (atEnd && !this.recording.report.value) this.lines.scrollTop = this.lines.scrollHeight;
  }

  private line(event: Happening): HTMLElement {
    const { number, timeS, kind, source, text, level } = event;
    const element = h("div", { class: "log-line", role: "option", id: `event-${number}`, onclick: () => this.choose(event) },
      h("span", { class: "log-time" }, formatTime(timeS)), h("span", { class: "log-level" }, levelName(level)),
      h("span", { class: "log-kind" }, source === "" ? kind : `${kind} · ${source}`), h("span", { class: "log-text" }, text));
    element.dataset["level"] = levelName(level);
    return element;
  }

  private choose(event: Happening): void {
    this.chosen = event.number;
    this.mark();
    document.getElementById(`event-${event.number}`)?.scrollIntoView({ block: "nearest" });
    const report = this.recording.report.value;
    if (report && event.position !== null) this.recording.seek(Math.min(report.ticks, event.position)).catch(reportError);
  }

  private mark(): void {
    const id = `event-${this.chosen}`;
    for (const line of this.lines.children) line.setAttribute("aria-selected", String(line.id === id));
    if (document.getElementById(id)) this.lines.setAttribute("aria-activedescendant", id);
    else this.lines.removeAttribute("aria-activedescendant");
  }

  private onKey(event: KeyboardEvent): void {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (step === 0 || this.shown.length === 0) return;
    event.preventDefault();
    const at = this.shown.findIndex(({ number }) => number === this.chosen);
    const next = at < 0 ? this.shown.length - 1 : at + step;
    const wanted = this.shown[Math.min(this.shown.length - 1, Math.max(0, next))];
    if (wanted) this.choose(wanted);
  }
}
