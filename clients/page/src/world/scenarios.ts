// Scenarios of the server's installation. One at a time runs beside the world, in a world of its own; its
// checks are shown as soon as their results are certain, and its verdict at its end. Another client may have
// started it.
import type { Link } from "../link/link";
import { EventLevel, type ScenarioState } from "../link/messages";
import { h, setText } from "../ui/dom";
import { reportError, reportTold } from "../ui/toasts";
import { actButton, section } from "./act";
import { NameList, type NameRow } from "./name_list";
import { verdictOf } from "./verdict";

export class ScenariosSection {
  readonly element: HTMLElement;
  private readonly list = new NameList("scenarios", "Start", (row) => void this.start(row));
  private readonly title = h("span", { class: "menu-name" });
  private readonly verdict = h("span", { class: "verdict" });
  private readonly text = h("p", { class: "menu-note" });
  private readonly checks = h("ul", { class: "checks", tabindex: 0, "aria-label": "Checks" });
  private readonly stop = actButton("Stop", () => this.end(), "Stop the scenario");
  private readonly course = h("div", { class: "course", role: "group", "aria-label": "The scenario that runs or ran last", hidden: true },
    h("div", { class: "menu-row" }, this.title, h("span", { role: "status" }, this.verdict), this.stop), this.text, this.checks);
  private state: ScenarioState | null = null;
  private asking = false;
  private askAgain = false;

  constructor(private readonly link: Link) {
    this.element = section("Scenarios", h("p", { class: "menu-note" }, "Run beside this world, which they do not change."), this.course, this.list.element);
    link.told.on((body) => {
      if (body.case !== "event" || (body.value.kind !== "check" && body.value.kind !== "scenario")) return;
      void this.look();
      // With the menu closed, it is told all the same that one begins and how it ends.
      if (body.value.kind === "scenario" && !this.element.checkVisibility()) reportTold(body.value.text, body.value.level >= EventLevel.WARNING ? "error" : "note");
    });
  }

  show(names: readonly string[]): void {
    this.list.show(names);
    void this.look();
  }

  private async start(row: NameRow): Promise<void> {
    for (const other of this.list.rows) other.refuse("");
    try {
      await this.link.request({ case: "runScenario", value: { name: row.name } }, "ok");
    } catch (error) {
      row.refuse(error instanceof Error ? error.message : String(error));
    }
    await this.look();
  }

  private async end(): Promise<string> {
    await this.link.request({ case: "stopScenario", value: {} }, "ok");
    return "The scenario is being ended";
  }

  // One question at a time; a further one where more happened meanwhile.
  private async look(): Promise<void> {
    this.askAgain = this.asking;
    if (this.asking || !this.link.welcome) return;
    this.asking = true;
    const state = await this.link.request({ case: "readScenario", value: {} }, "scenario").catch((error: unknown) => reportError(error));
    this.asking = false;
    if (state) this.showState(state);
    if (this.askAgain) await this.look();
  }

  private showState(state: ScenarioState): void {
    const { name, running, text, checks } = state;
    const [words, tone] = verdictOf(state);
    // Another run begins with an empty list.
    if (name !== this.state?.name || checks.length < this.checks.children.length || (running && !this.state.running)) this.checks.replaceChildren();
    this.state = state;
    this.course.hidden = name === "";
    setText(this.title, name);
    setText(this.verdict, words);
    this.verdict.dataset["tone"] = tone;
    setText(this.text, running ? (checks.length === 0 ? "A check appears here as soon as its result is certain." : "") : text);
    this.text.hidden = this.text.textContent === "";
    this.stop.hidden = !running;
    this.stop.disabled = !this.link.mayChangeWorld;
    this.checks.append(...checks.slice(this.checks.children.length).map(checkLine));
    for (const row of this.list.rows) row.button.disabled = running || !this.link.mayChangeWorld;
  }
}

function checkLine({ name, passed, text }: ScenarioState["checks"][number]): HTMLElement {
  const mark = h("span", { class: "check-mark" }, passed ? "✓ passed" : "✗ failed");
  mark.dataset["tone"] = passed ? "good" : "bad";
  return h("li", {}, mark, h("span", { class: "check-name" }, name), h("span", { class: "check-text" }, text));
}
