// Time, always in sight: run and pause, single ticks, speed, reset, and how fast and how punctually the world
// runs.
import type { Link } from "../link/link";
import { Role, type ServerStatus } from "../link/messages";
import type { Clock } from "../model/clock";
import type { Recording } from "../model/recording";
import { h, iconButton, setText } from "../ui/dom";
import { icons } from "../ui/icons";
import { formatNs, formatTime } from "../ui/numbers";
import { reportError } from "../ui/toasts";

const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 5, 10];

export class TimeControls {
  readonly element: HTMLElement;
  private readonly run: HTMLButtonElement;
  private readonly runIcon: SVGPathElement;
  private readonly tick = iconButton(icons.step, "Single tick", () => this.step(1));
  private readonly count = h("input", { type: "number", class: "ticks", min: 1, max: 1_000_000, value: "100", "aria-label": "Number of ticks" });
  private readonly many = h("button", { type: "button", class: "small", onclick: () => this.step(this.count.valueAsNumber) }, "ticks");
  private readonly reset = iconButton(icons.reset, "Reset the world", () => this.resetWorld());
  private readonly speed = h("select", { "aria-label": "Speed" });
  private readonly time = h("output", { class: "sim-time", "aria-label": "Simulated time" });
  private readonly factor = meter("RTF", "Real-time factor: simulated per wall time over the last second");
  private readonly overruns = meter("Overruns", "Ticks that began more than a tick late");
  private readonly lateness = meter("Late p99.9", "How late ticks begin: of a thousand, one is later");

  constructor(private readonly link: Link, private readonly clock: Clock, private readonly recording: Recording, private readonly resetWorld: () => void) {
    // Until it is known whether time runs
    this.run = iconButton(icons.play, "Run", () => this.toggle(), { class: "icon primary", disabled: true });
    this.runIcon = this.run.querySelector("path")!;
    this.speed.addEventListener("change", () => this.clock.setSpeed(Number(this.speed.value)).catch(reportError));
    this.element = h(
      "div",
      { class: "time", role: "group", "aria-label": "Time" },
      this.run, this.tick, h("span", { class: "many" }, this.count, this.many), this.speed, this.reset, this.time,
      h("div", { class: "meters" }, this.factor.element, this.overruns.element, this.lateness.element),
    );
    // With the server gone, nothing here can be done
    link.state.watch(({ kind }) => kind !== "open" && this.disable());
    for (const changed of [clock.status, clock.stepping]) changed.watch(() => clock.status.value && this.show(clock.status.value));
  }

  // Between two status answers, samples give the time.
  showTime(seconds: number): void {
    setText(this.time, formatTime(seconds));
  }

  private disable(): void {
    for (const control of [this.run, this.tick, this.many, this.count, this.reset, this.speed]) control.disabled = true;
  }

  private show(status: ServerStatus): void {
    if (!this.link.welcome) return this.disable();
    const admin = this.link.welcome?.role === Role.ADMIN;
    const stands = (status.paused && !this.clock.stepping.value) || status.frozen;
    this.runIcon.setAttribute("d", stands ? icons.play : icons.pause);
    this.run.setAttribute("aria-label", stands ? "Run" : "Pause");
    this.run.title = stands ? "Run (Space)" : "Pause (Space)";
    this.run.disabled = !admin || (status.frozen && !this.recording.atEnd);
    for (const control of [this.tick, this.many, this.count]) control.disabled = !admin || !status.paused || status.frozen;
    this.reset.disabled = !this.link.mayChangeWorld;
    this.speed.disabled = !admin || status.clock !== "realtime";
    this.showSpeed(status);
    this.showTime(Number(status.simTimeNs) / 1e9);
    this.showMeters(status);
  }

  private showSpeed(status: ServerStatus): void {
    const speeds = [...new Set([...kSpeeds, status.speed])].sort((a, b) => a - b);
    const wanted = speeds.map((speed) => `${speed}×`).join();
    if (this.speed.dataset["list"] !== wanted) {
      this.speed.dataset["list"] = wanted;
      this.speed.replaceChildren(...speeds.map((speed) => h("option", { value: speed }, `${speed}×`)));
    }
    if (document.activeElement !== this.speed) this.speed.value = String(status.speed);
    this.speed.title = status.clock === "realtime" ? "Simulated seconds per second" : `The speed cannot be set: the clock is ${status.clock}`;
  }

  private showMeters(status: ServerStatus): void {
    const stands = status.paused || status.frozen;
    this.factor.show(stands ? "–" : status.realTimeFactor.toFixed(2), !stands && status.clock === "realtime" && status.realTimeFactor < 0.95 * status.speed);
    this.overruns.show(String(status.overruns), false);
    this.lateness.show(formatNs(Number(status.latenessP999Ns)), false);
  }

  private toggle(): void {
    const status = this.clock.status.value;
    const stands = status?.paused && !this.clock.stepping.value;
    (stands ? this.resume() : this.clock.pause()).catch(reportError);
  }
  // A recording at its end begins again.
  private async resume(): Promise<void> {
    if (this.recording.atEnd) await this.recording.seek(0);
    await this.clock.resume();
  }
  toggleRun(): void {
    if (!this.run.disabled) this.toggle();
  }

  private step(ticks: number): void {
    if (!Number.isInteger(ticks) || ticks < 1) return reportError(new Error("the number of ticks must be a whole number from 1"));
    this.clock.step(ticks).catch(reportError);
  }
}

function meter(name: string, title: string) {
  const value = h("span", { class: "meter-value" }, "–");
  const element = h("div", { class: "meter", title }, h("span", { class: "meter-name" }, name), value);
  return {
    element,
    show(text: string, bad: boolean) {
      setText(value, text);
      element.classList.toggle("bad", bad);
    },
  };
}
