// As much of a document as widgets touch, for tests without a browser; imported before all that makes
// elements.

class Element extends EventTarget {
  className = "";
  textContent = "";
  type = "";
  value = "";
  title = "";
  checked = false;
  disabled = false;
  hidden = false;
  tabIndex = -1;
  clientWidth = 100;
  clientHeight = 100;
  readonly dataset: Record<string, string> = {};
  readonly style: Record<string, string> = {};
  readonly attributes = new Map<string, string>();
  readonly classList = { add: () => undefined, remove: () => undefined, toggle: () => false };
  children: Element[] = [];
  private parent: Element | null = null;
  private captured = false;

  constructor(readonly tagName: string) {
    super();
  }
  get valueAsNumber(): number {
    return this.value === "" ? NaN : Number(this.value);
  }
  get isConnected(): boolean {
    return this.parent !== null;
  }
  get firstElementChild(): Element | undefined {
    return this.children[0];
  }
  get lastElementChild(): Element | undefined {
    return this.children.at(-1);
  }
  append(...children: (Element | string)[]): void {
    for (const child of children) {
      if (typeof child === "string") this.textContent += child;
      else this.children.push(Object.assign(child, { parent: this }));
    }
  }
  replaceChildren(...children: Element[]): void {
    this.children = [];
    this.append(...children);
  }
  remove(): void {
    if (this.parent) this.parent.children = this.parent.children.filter((child) => child !== this);
    this.parent = null;
  }
  setAttribute = (name: string, value: string) => void this.attributes.set(name, value);
  getAttribute = (name: string) => this.attributes.get(name) ?? null;
  getBoundingClientRect = () => ({ left: 0, top: 0, width: this.clientWidth, height: this.clientHeight });
  setPointerCapture = () => void (this.captured = true);
  hasPointerCapture = () => this.captured;
  closest = () => null;
}

const body = new Element("body");
Object.assign(globalThis, {
  matchMedia: () => ({ matches: false }),
  document: {
    body,
    createElement: (tag: string) => new Element(tag),
    createElementNS: (_: string, tag: string) => new Element(tag),
  },
});

// Sends an event to an element, with these details.
export function happens(element: object, type: string, details: object = {}): void {
  (element as Element).dispatchEvent(Object.assign(new Event(type), details));
}

// All elements of a kind below one, itself included.
export function all(root: object, tag: string): HTMLInputElement[] {
  const element = root as Element;
  const below = element.children.flatMap((child) => all(child, tag));
  return element.tagName === tag ? [element as unknown as HTMLInputElement, ...below] : below;
}

// The words at the lower edge that were not taken so far.
export function toasts(): string[] {
  const words = body.children.flatMap((place) => place.children).map(({ textContent }) => textContent);
  for (const place of body.children) place.replaceChildren();
  return words;
}
