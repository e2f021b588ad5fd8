// A list of names that can be searched, each with a button and a place for what the server says to it.
import { h, setText } from "../ui/dom";

export interface NameRow {
  readonly name: string;
  readonly element: HTMLElement;
  readonly button: HTMLButtonElement;
  refuse(text: string): void; // shows why the server did not do it; empty: nothing
}

export class NameList {
  readonly element: HTMLElement;
  readonly rows: NameRow[] = [];
  private readonly search: HTMLInputElement;
  private readonly list: HTMLUListElement;
  private readonly none = h("p", { class: "menu-note", role: "status" });
  private shown = ""; // the names of the rows

  // `what`: the things in the plural, in small letters. `act`: the word on the buttons.
  constructor(private readonly what: string, private readonly act: string, private readonly press: (row: NameRow) => void) {
    this.search = h("input", { type: "search", placeholder: `search ${what}`, "aria-label": `Search ${what}` });
    this.list = h("ul", { class: "names", "aria-label": what });
    this.search.addEventListener("input", () => this.filter());
    this.element = h("div", { class: "name-list" }, this.search, this.list, this.none);
  }

  // Rows that are there stay, so that a user who is at one keeps the place.
  show(names: readonly string[]): void {
    const now = names.join("\n");
    if (now !== this.shown) {
      this.shown = now;
      this.rows.splice(0, this.rows.length, ...names.map((name) => this.row(name)));
      this.list.replaceChildren(...this.rows.map(({ element }) => element));
    }
    this.filter();
  }

  private row(name: string): NameRow {
    const refusal = h("p", { class: "refusal", role: "alert", hidden: true });
    const button = h("button", { type: "button", class: "small", "aria-label": `${this.act} ${name}`, onclick: () => this.press(row) }, this.act);
    const row: NameRow = {
      name, button,
      element: h("li", {}, h("span", { class: "menu-name", title: name }, name), button, refusal),
      refuse: (text) => {
        setText(refusal, text);
        refusal.hidden = text === "";
      },
    };
    return row;
  }

  private filter(): void {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = this.rows.filter(({ name, element }) => !(element.hidden = !words.every((word) => name.toLowerCase().includes(word))));
    this.search.hidden = this.rows.length === 0;
    this.none.hidden = found.length > 0;
    setText(this.none, this.rows.length === 0 ? `This server has no ${this.what}.` : `No name among ${this.rows.length} ${this.what} has this in it.`);
  }
}
