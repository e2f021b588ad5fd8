// Records the running world into a file of the server. One recording at a time; another client may have begun
// or ended it, which its events tell.
import type { Link } from "../link/link";
import type { Events } from "../model/events";
import { h, setText } from "../ui/dom";
import { reportError } from "../ui/toasts";
import { actButton, section } from "./act";

const kBegun = /^recording '(.*)' has begun$/; // server/gateway/event_requests.cc

export class RecordingSection {
  readonly element: HTMLElement;
  private readonly name = h("input", { type: "text", placeholder: "name", "aria-label": "Name of the recording" });
  private readonly toggle: HTMLButtonElement;
  private readonly words = h("p", { class: "recording-words", role: "status" });
  private running = "";

  constructor(private readonly link: Link, private readonly events: Events) {
    this.toggle = actButton("Record", () => this.press());
    this.name.addEventListener("keydown", (event) => event.key === "Enter" && this.toggle.click());
    this.element = section("Recording", h("div", { class: "menu-row" }, this.name, this.toggle), this.words);
    events.happened.on(({ kind }) => kind === "recording" && this.show());
    events.cleared.on(() => this.show());
    this.show();
  }

  private async press(): Promise<string> {
    if (this.running !== "") {
      await this.link.request({ case: "stopRecording", value: {} }, "ok");
      return "The recording has ended";
    }
    const name = this.name.value.trim();
    if (name === "") {
      reportError(new Error("Give the recording a name first"));
      this.name.focus();
      return "";
    }
    await this.link.request({ case: "startRecording", value: { name } }, "ok");
    return `Recording '${name}'`;
  }

  private show(): void {
    const last = this.events.list.filter(({ kind }) => kind === "recording").at(-1);
    this.running = kBegun.exec(last?.text ?? "")?.[1] ?? "";
    const runs = this.running !== "";
    setText(this.toggle, runs ? "Stop recording" : "Record");
    this.toggle.setAttribute("aria-label", runs ? "Stop recording" : "Record");
    this.toggle.classList.toggle("records", runs);
    this.name.hidden = runs;
    this.words.hidden = !runs;
    setText(this.words, runs ? `The server writes ${this.running}.mcap` : "");
  }
}
