// The time of a tick, phase by phase, over the last second: its mean and its longest duration.
import type { Link } from "../link/link";
import type { PhaseTime } from "../link/messages";
import type { Clock } from "../model/clock";
import { h, setText } from "../ui/dom";
import { formatNs } from "../ui/numbers";

export function profileView(link: Link, clock: Clock): HTMLElement {
  const total = h("span", { class: "count" });
  const rows = h("tbody", {});
  const head = h("tr", {}, ...["Phase", "Share of a tick", "Mean", "Longest"].map((text) => h("th", { scope: "col" }, text)));
  const table = h("table", { class: "profile" }, h("caption", {}, "Over the last second"), h("thead", {}, head), rows);
  const details = h("details", { class: "side" }, h("summary", {}, h("span", {}, "Cycle"), total), table);
  clock.status.watch((status) => {
    const tickNs = Number(link.welcome?.tickNs ?? 0n);
    if (!status || tickNs === 0) return;
    const spentNs = status.phases.reduce((sum, { meanNs }) => sum + Number(meanNs), 0);
    setText(total, `${formatNs(spentNs)} of ${formatNs(tickNs)}`);
    if (details.open) rows.replaceChildren(...status.phases.map((phase) => row(phase, tickNs)));
  });
  return details;
}

function row({ name, meanNs, maxNs }: PhaseTime, tickNs: number): HTMLElement {
  const share = h("span", { class: "profile-share" });
  share.style.width = `${Math.min(100, (100 * Number(meanNs)) / tickNs).toFixed(1)}%`;
  return h("tr", {}, h("th", { scope: "row" }, name), h("td", { "aria-hidden": "true" }, share),
    h("td", {}, formatNs(Number(meanNs))), h("td", {}, formatNs(Number(maxNs))));
}
