// The time of a recording: a slider over all of it, a mark at the first tick whose bits differ from this
// program's, and a sentence on what was found. With a second recording, what was found is where the two part.
import { whereTheyPart, type BesideReport, type DifferentPort } from "../model/beside";
import type { Recording, Report } from "../model/recording";
import { h, setText } from "../ui/dom";
import { formatTime } from "../ui/numbers";
import { reportError } from "../ui/toasts";
import { Differences } from "./differences";

// `plot`: plots a port that differs.
export function timeline(recording: Recording, plot: (port: DifferentPort) => void): HTMLElement {
  const slider = h("input", { type: "range", min: 0, max: 0, step: 1, value: 0, "aria-label": "Time of the recording" });
  const mark = h("span", { class: "difference-mark", hidden: true });
  const time = h("output", { class: "timeline-time" });
  const words = h("span", { class: "timeline-words", role: "status" });
  const jump = h("button", { type: "button", class: "small", hidden: true, onclick: () => go(firstOf(recording.report.value)) }, "Go there");
  const differences = new Differences((position) => go(position), plot, recording);
  const element = h("div", { class: "timeline", role: "group", "aria-label": "Recording", hidden: true },
    h("div", { class: "timeline-track" }, slider, mark, differences.marks), time, h("div", { class: "timeline-found" }, differences.names, words, jump, differences.list));
  const go = (position: number | undefined) => {
    if (position !== undefined) recording.seek(Math.min(position, recording.report.value?.ticks ?? 0)).catch(reportError);
  };
  slider.addEventListener("input", () => go(slider.valueAsNumber));
  const showTime = () => {
    const report = recording.report.value;
    if (!report) return;
    const seconds = (ticks: number) => (ticks * report.tick_ns) / 1e9;
    slider.value = String(recording.position.value);
    const text = `${formatTime(seconds(recording.position.value))} of ${formatTime(seconds(report.ticks))}`;
    slider.setAttribute("aria-valuetext", text);
    setText(time, text);
  };
  recording.report.watch((report) => {
    element.hidden = report === null;
    if (!report) return;
    slider.max = String(report.ticks);
    const { difference, beside } = report;
    mark.hidden = difference === undefined;
    jump.hidden = firstOf(report) === undefined;
    if (difference) mark.style.setProperty("--at", String(difference.position / Math.max(1, report.ticks)));
    element.dataset["equal"] = String(report.equal && !beside?.first);
    setText(words, beside ? whatOfBoth(report, beside) : whatWasFound(report));
    words.title = words.textContent ?? "";
    showTime();
  });
  recording.position.watch(showTime);
  return element;
}

function firstOf(report: Report | null): number | undefined {
  return report?.beside ? report.beside.first?.position : report?.difference?.position;
}

// The comparison of the two; and that of A with this program, if it found something.
function whatOfBoth(report: Report, beside: BesideReport): string {
  const own = report.difference ? ` A alone: ${whatWasFound(report)}` : "";
  return whereTheyPart(report.ticks, beside) + own;
}

// Pure.
export function whatWasFound(report: Report): string {
  const { difference, damage } = report;
  const end = damage === "" ? "" : ` The file is damaged: ${damage}.`;
  const count = (ticks: number) => ticks.toLocaleString("en");
  if (difference) {
    const ports = difference.ports.map(({ part, port, recorded, replayed }) => `${part}, ${port}: recorded ${recorded}, replayed ${replayed}`);
    const other = difference.other_build === "" ? "" : ` It was recorded by another build: ${difference.other_build}.`;
    return `First difference at tick ${count(difference.tick)}${difference.era === 1 ? "" : ` of era ${difference.era}`}: ${difference.what}. ${ports.length > 0 ? `${ports.join("; ")}.` : "No recorded port differs."}${other}${end}`;
  }
  if (report.compared < report.ticks) return `The same bits in ${count(report.compared)} of ${count(report.ticks)} ticks so far.${end}`;
  return `The same bits in all ${count(report.ticks)} ticks.${end}`;
}
