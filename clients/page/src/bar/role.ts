// The choice of what this page may do. It stands in the bar, and where that is too narrow in the menu World.
import type { Link } from "../link/link";
import { Role } from "../link/messages";
import type { Parts } from "../model/parts";
import { h } from "../ui/dom";
import { reportError } from "../ui/toasts";

const kRoles: [Role, string][] = [[Role.OBSERVER, "Observer"], [Role.CONTROLLER, "Controller"], [Role.ADMIN, "Admin"]];

export function roleChoice(link: Link, parts: Parts): HTMLSelectElement {
  const role = h("select", { "aria-label": "Role", class: "role", title: "The role of this page: what it may do" },
    ...kRoles.map(([value, name]) => h("option", { value }, name)));
  role.value = String(link.role);
  // A role comes with a new session. The leases of the old session would be lost with it, and the parts would
  // stop.
  const change = async (wanted: Role) => {
    try {
      await parts.releaseAll();
      link.useRole(wanted);
    } catch (error) {
      reportError(error);
      role.value = String(link.welcome?.role ?? link.role);
    }
  };
  role.addEventListener("change", () => void change(Number(role.value)));
  link.state.watch((state) => {
    role.disabled = state.kind !== "open";
    if (state.kind === "open") role.value = String(state.welcome.role);
  });
  return role;
}
