// Elements without a framework: h("button", { class: "x", onclick: f }, "Text").

type Child = Node | string | null | undefined | false;
type Props = Record<string, unknown>;

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, props: Props = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  set(element, props);
  add(element, children);
  return element;
}

export function svg(path: string, size = 16): SVGSVGElement {
  const ns = "http://www.w3.org/2000/svg";
  const root = document.createElementNS(ns, "svg");
  root.setAttribute("viewBox", "0 0 16 16");
  root.setAttribute("width", String(size));
  root.setAttribute("height", String(size));
  root.setAttribute("aria-hidden", "true");
  const shape = document.createElementNS(ns, "path");
  shape.setAttribute("d", path);
  root.append(shape);
  return root;
}

function set(element: HTMLElement, props: Props): void {
  for (const [name, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value as EventListener);
    else if (name === "class") element.className = String(value);
    else if (name in element && !name.startsWith("aria") && name !== "list" && name !== "role")
      (element as unknown as Props)[name] = value;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
}

function add(element: HTMLElement, children: Child[]): void {
  for (const child of children) if (child) element.append(child);
}

// For text that changes often: touches the document only if the text differs.
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function iconButton(path: string, label: string, onclick: () => void, props: Props = {}): HTMLButtonElement {
  return h("button", { type: "button", class: "icon", title: label, "aria-label": label, onclick, ...props }, svg(path));
}
