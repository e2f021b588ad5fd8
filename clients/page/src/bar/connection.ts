// The state of the connection to visumd, the role of this page, and what to do if the connection is lost.
import type { Link, LinkState } from "../link/link";
import type { Clock } from "../model/clock";
import type { Parts } from "../model/parts";
import { h, setText } from "../ui/dom";
import { roleChoice } from "./role";

export function connectionBadge(link: Link, parts: Parts, clock: Clock): HTMLElement {
  const text = h("span", {}, "Connecting");
  const others = h("span", { class: "others" });
  const element = h("div", { class: "connection" }, h("span", { class: "dot" }), text, others, roleChoice(link, parts));
  const show = () => {
    const frozen = clock.status.value?.frozen ?? false;
    element.dataset["frozen"] = String(frozen);
    setText(text, words(link.state.value, link.recorded.value, frozen));
    setText(others, whoIsHere(clock.status.value?.sessions ?? 1));
    others.title = parts.list.value.filter(({ holder }) => holder.value !== "").map(({ name, holder }) => `'${holder.value}' commands ${name}`).join("; ");
  };
  clock.status.watch(show);
  link.state.watch((state) => {
    element.dataset["state"] = state.kind;
    show();
    if (state.kind !== "open") return;
    element.title = `Session ${state.welcome.session} of ${state.welcome.server || "visumd"}, as '${link.name}'`;
  });
  link.recorded.watch((recorded) => {
    element.dataset["recorded"] = String(recorded);
    show();
  });
  return element;
}

function words(state: LinkState, recorded: boolean, frozen: boolean): string {
  if (state.kind === "open") return recorded ? "Recorded" : frozen ? "Frozen" : "Live";
  if (state.kind === "token") return "Token needed";
  return state.kind === "lost" ? "Reconnecting" : "Connecting";
}

// Virtual, real or recorded: these must not be mistaken for each other.
export function realityBadge(link: Link): HTMLElement {
  const element = h("span", { class: "reality" }, "–");
  link.state.watch((state) => {
    if (state.kind !== "open") return;
    element.dataset["real"] = String(!state.welcome.simulated);
    setText(element, state.welcome.simulated ? "Virtual" : "Real");
    element.title = state.welcome.simulated ? "A simulated world" : "Real hardware moves behind these ports";
  });
  link.recorded.watch((recorded) => {
    element.dataset["recorded"] = String(recorded);
    if (!recorded) return;
    setText(element, "Recording");
    element.title = "This happened in the past; nothing in it can be changed";
  });
  return element;
}

// Covers the view while no data come: the reason, and since when. If the server needs a token, there is a
// field for it.
export function lostBanner(link: Link): HTMLElement {
  const reason = h("p", {});
  const token = h("input", { type: "password", autocomplete: "off", "aria-label": "Token", placeholder: "Token" });
  const form = h("form", { hidden: true }, token, h("button", { type: "submit" }, "Connect"));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    link.useToken(token.value);
    token.value = "";
  });
  const title = h("h2", {});
  const element = h("div", { class: "banner", role: "alert", hidden: true }, title, reason, form);
  const show = () => {
    const state = link.state.value;
    element.hidden = state.kind === "open" || state.kind === "connecting";
    form.hidden = state.kind !== "token";
    if (state.kind === "token") {
      setText(title, "A token is needed");
      setText(reason, `visumd says: ${state.reason}.`);
    }
    if (state.kind !== "lost") return;
    setText(title, "No data from visumd");
    setText(reason, `${state.reason} · for ${Math.round((Date.now() - state.since) / 1000)} s, trying again`);
  };
  link.state.watch(show);
  setInterval(show, 1000);
  return element;
}

// Pure.
export function whoIsHere(sessions: number): string {
  return sessions < 2 ? "" : sessions === 2 ? "and 1 other" : `and ${sessions - 1} others`;
}
