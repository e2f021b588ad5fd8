// Another scene in the world's place: one of the server's installation, chosen by its name.
import { whoElse } from "../bar/reset";
import type { Link } from "../link/link";
import type { Clock } from "../model/clock";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import { ask } from "../ui/ask";
import { setText } from "../ui/dom";
import { section } from "./act";
import { NameList, type NameRow } from "./name_list";

const kLoad = "Load";

export class ScenesSection {
  readonly element: HTMLElement;
  private readonly list = new NameList("scenes", kLoad, (row) => void this.load(row));
  private loading: NameRow | null = null;

  constructor(private readonly link: Link, private readonly world: World, private readonly parts: Parts, private readonly clock: Clock) {
    this.element = section("Scenes", this.list.element);
    world.description.watch(() => this.mark());
  }

  show(names: readonly string[]): void {
    this.list.show(names);
    this.mark();
  }

  // The scene that is loaded says so. It can be loaded anew.
  private mark(): void {
    const here = this.world.description.value?.scene;
    for (const row of this.list.rows) {
      row.element.classList.toggle("here", row.name === here);
      row.button.disabled = this.loading !== null || !this.link.mayChangeWorld;
      const words = row === this.loading ? "Loading…" : row.name === here ? "Load anew" : kLoad;
      setText(row.button, words);
      row.button.setAttribute("aria-label", `${words} ${row.name}`);
    }
  }

  private async load(row: NameRow): Promise<void> {
    for (const other of this.list.rows) other.refuse("");
    const concerned = whoElse(this.link.name, this.parts.list.value.map((part) => part.holder.value), this.clock.status.value?.sessions ?? 1);
    if (concerned !== "" && !(await ask(`Load the scene '${row.name}' in place of this world? ${concerned}`, "Load the scene"))) return;
    this.loading = row;
    this.mark();
    try {
      await this.link.request({ case: "loadScene", value: { scene: row.name } }, "ok");
    } catch (error) {
      row.refuse(error instanceof Error ? error.message : String(error));
    } finally {
      this.loading = null;
      this.mark();
    }
  }
}
