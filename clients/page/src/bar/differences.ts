// Where two recordings differ: marks on the ruler of their time, and a list of the ports that part first. A
// click on either goes there; one on a port plots it, too.
import { inShort, whereTheyPart, type BesideReport, type DifferentPort } from "../model/beside";
import type { Recording, Report } from "../model/recording";
import { h, setText } from "../ui/dom";
import { popover } from "../ui/popover";

export class Differences {
  readonly marks = h("div", { class: "parting-marks" }); // for the track
  readonly names = h("span", { class: "timeline-pair", hidden: true });
  readonly list: HTMLDetailsElement;
  private readonly content = h("div", { class: "differences" });
  private shown = "";

  constructor(private readonly go: (position: number) => void, private readonly plot: (port: DifferentPort) => void, recording: Recording) {
    this.list = popover("Differences", this.content);
    this.list.classList.add("differing");
    this.list.hidden = true;
    recording.report.watch((report) => this.show(report));
  }

  private show(report: Report | null): void {
    const beside = report?.beside;
    this.names.hidden = !beside;
    this.list.hidden = !beside || (!beside.first && beside.only_a.length + beside.only_b.length + beside.settings.length === 0);
    const now = JSON.stringify(beside && [beside.first, beside.ports, beside.port_count, beside.settings]);
    // The list that a user looks at stays until all is compared.
    if (!report || !beside || now === this.shown || (this.list.open && !beside.over)) return;
    this.shown = now;
    setText(this.names, `A ${report.file} · B ${beside.file} (ghost, dashed)`);
    setText(this.list.querySelector("summary")!, beside.port_count > 0 ? `Differences (${beside.port_count})` : "Differences");
    this.marks.replaceChildren(...this.placed(report, beside));
    this.content.replaceChildren(...this.rows(beside));
  }

  // The first tick that differs, and those at which further ports begin to.
  private placed(report: Report, beside: BesideReport): HTMLElement[] {
    const { first } = beside;
    if (!first) return [];
    const later = [...new Set(beside.ports.map(({ position }) => position))].filter((position) => position !== first.position);
    const mark = (position: number, text: string, kind: string) => {
      const element = h("button", { type: "button", class: `parting-mark ${kind}`, title: text, "aria-label": text, tabindex: -1, onclick: () => this.go(position) });
      element.style.setProperty("--at", String(Math.min(1, position / Math.max(1, report.ticks))));
      return element;
    };
    const names = (position: number) => beside.ports.filter((port) => port.position === position).map(({ part, port }) => `${part}, ${port}`).join("; ");
    return [...later.map((position) => mark(position, `Also from here: ${names(position)}`, "later")), mark(first.position, whereTheyPart(report.ticks, beside), "first")];
  }

  private rows({ ports, port_count, settings, only_a, only_b }: BesideReport): HTMLElement[] {
    const list = (head: string, texts: string[]) => (texts.length === 0 ? [] : [h("h3", {}, head), h("ul", {}, ...texts.map((text) => h("li", {}, text)))]);
    const row = (port: DifferentPort) => {
      const name = `${port.part}/${port.port}`;
      const choose = () => {
        this.go(port.position);
        this.plot(port);
      };
      const number = (text: string) => h("td", { title: text }, inShort(text));
      return h("tr", {}, h("td", {}, h("button", { type: "button", class: "small", title: `Go to its first difference, and plot it`, onclick: choose }, name)),
        h("td", {}, port.tick.toLocaleString("en")), number(port.a), number(port.b), number(port.max_abs), h("td", {}, port.max_tick.toLocaleString("en")));
    };
    const head = ["port", "from tick", "A", "B", "at most apart", "at tick"].map((name) => h("th", { scope: "col" }, name));
    const table = ports.length === 0 ? [] : [h("table", {}, h("thead", {}, h("tr", {}, ...head)), h("tbody", {}, ...ports.map(row)))];
    const more = port_count > ports.length ? [h("p", {}, `${port_count - ports.length} more ports; \`visum compare\` lists all`)] : [];
    return [...table, ...more, ...list("Made differently", settings), ...list("Only in A", only_a), ...list("Only in B", only_b)];
  }
}
