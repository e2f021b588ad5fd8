// A part in the tree: the holder of its lease, and its ports by interface and group.
import type { Link } from "../link/link";
import { Role } from "../link/messages";
import type { Part, Port, Side } from "../model/part";
import { h, setText } from "../ui/dom";
import { startPortDrag } from "../ui/drag";
import { ask } from "../ui/ask";
import { report, reportError } from "../ui/toasts";
import { blackboardsView } from "./blackboards";
import { parametersView, type ParametersView } from "./parameters";
import { PortRow, type RowActions } from "./row";

export class PartView {
  readonly element: HTMLElement;
  readonly rows: PortRow[] = [];
  private readonly parameters: ParametersView | null;
  private readonly groups: { element: HTMLDetailsElement; rows: PortRow[] }[] = [];
  private before: boolean[] | null = null; // during a search: which groups were open before it
  private readonly holder = h("span", { class: "holder" });
  private readonly lease = h("button", { type: "button", class: "lease" });
  private readonly stops: (() => void)[] = [];

  constructor(private readonly link: Link, readonly part: Part, private readonly actions: RowActions) {
    this.lease.addEventListener("click", () => void this.toggleLease());
    const blackboards = blackboardsView(link, part);
    this.parameters = parametersView(link, part);
    this.element = h(
      "section",
      { class: "part", "aria-label": `Part ${part.name}` },
      h("header", {}, h("h2", {}, part.name), h("span", { class: "kind" }, part.description.kind), this.holder, this.lease),
      this.side("input", "Controller Input"),
      this.side("output", "Sensor Output"),
      this.parameters?.element,
      blackboards?.element,
    );
    if (blackboards) this.stops.push(blackboards.stop);
    this.stops.push(part.gaveUp.on((words) => report(words, "error")));
    const show = () => this.showLease();
    this.stops.push(part.holder.watch(show), part.leased.watch(show), link.recorded.watch(show), link.state.watch(show));
  }

  dispose(): void {
    for (const stop of this.stops) stop();
  }

  // Shows the ports and parameters that match all words, and opens their groups. Without a word, everything
  // is as it was before the search. Returns whether anything matches.
  filter(words: string[]): boolean {
    const parameters = this.parameters?.filter(words) ?? false;
    if (words.length > 0) this.before ??= this.groups.map(({ element }) => element.open);
    for (const row of this.rows) row.element.hidden = !row.matches(words);
    for (const { element, rows } of this.groups) {
      const any = rows.some((row) => !row.element.hidden);
      element.hidden = !any;
      if (words.length > 0) element.open = any;
    }
    const found = parameters || this.rows.some((row) => !row.element.hidden);
    this.element.hidden = words.length > 0 && !found;
    if (words.length > 0 || !this.before) return found;
    this.groups.forEach(({ element }, i) => (element.open = this.before![i]!));
    this.before = null;
    return found;
  }

  private side(side: Side, title: string): HTMLElement {
    const ports = this.part.ports.filter((port) => port.side === side);
    const byGroup = new Map<string, Port[]>();
    for (const port of ports) {
      const group = port.description.group || port.description.name;
      byGroup.set(group, [...(byGroup.get(group) ?? []), port]);
    }
    const body = [...byGroup].map(([name, members]) => (members.length === 1 ? this.row(members[0]!, members[0]!.description.name).element : this.group(name, members)));
    const details = h("details", { class: "side", open: true }, h("summary", {}, h("span", {}, title), h("span", { class: "count" }, String(ports.length))), ...body);
    this.groups.push({ element: details, rows: this.rows.filter((row) => row.port.side === side) });
    return details;
  }

  private group(name: string, ports: Port[]): HTMLElement {
    // Below the group's name, a port shows only its own part of the name.
    const rows = ports.map((port) => this.row(port, port.description.name.replace(name, "").trim() || port.description.name));
    const summary = h("summary", { draggable: true }, h("span", {}, name), h("span", { class: "count" }, String(ports.length)));
    summary.addEventListener("dragstart", (event) => startPortDrag(event, ports));
    const open = this.part.ports.length <= 24 || name.startsWith("Desired Angle") || name.startsWith("Actual Angle");
    const element = h("details", { class: "group", open }, summary, ...rows.map((row) => row.element));
    this.groups.push({ element, rows });
    return element;
  }

  private row(port: Port, label: string): PortRow {
    const row = new PortRow(port, label, this.actions);
    this.rows.push(row);
    return row;
  }

  private showLease(): void {
    const { leased, holder } = this.part;
    const connected = this.link.welcome !== null;
    // Nobody commands a sensor
    this.lease.hidden = this.holder.hidden = this.part.description.controllerInputs.length === 0 || !connected;
    setText(this.holder, leased.value ? "yours" : holder.value === "" ? "free" : holder.value);
    this.holder.dataset["state"] = leased.value ? "mine" : holder.value === "" ? "free" : "taken";
    this.holder.title = leased.value ? "This page holds the lease" : holder.value === "" ? "The lease is free" : `'${holder.value}' holds the lease`;
    const take = !leased.value && holder.value !== "";
    setText(this.lease, leased.value ? "Release" : take ? "Take over" : "Take control");
    this.lease.disabled = !this.link.mayCommand;
    this.lease.title = this.link.recorded.value ? "A recording: what happened cannot be changed" : "";
    if (this.link.recorded.value) this.holder.hidden = true;
    for (const row of this.rows) row.setEditable(leased.value && connected);
  }

  private async toggleLease(): Promise<void> {
    const { leased, holder, name } = this.part;
    const taking = !leased.value && holder.value !== "";
    try {
      if (leased.value) return await this.part.release();
      if (!taking) return await this.part.acquire();
      // Taking over stops the part and takes the lease from its holder. That must not happen by a slip of the
      // hand.
      const isAdmin = this.link.welcome?.role === Role.ADMIN;
      if (!isAdmin || (await ask(`Take '${name}' from '${holder.value}'? The part stops on a ramp and latches a fault.`, "Take it")))
        await this.part.acquire(isAdmin);
    } catch (error) {
      reportError(error);
    }
  }
}
