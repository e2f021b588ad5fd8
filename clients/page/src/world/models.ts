// Models that come and go while the world runs, with their parts: of the server's models, or of a folder of
// this machine, whose files are sent.
import type { Link } from "../link/link";
import type { World } from "../model/world";
import { h } from "../ui/dom";
import { pickFolder } from "../ui/files";
import { reportError } from "../ui/toasts";
import { actButton, section } from "./act";
import { isModel, isOfModel, poseOf, type Sent } from "./model_files";

const kOwn = "own/"; // before the path of a file of this machine, as the value of its choice

export class ModelsSection {
  readonly element: HTMLElement;
  private readonly file = h("select", { "aria-label": "Model to add" });
  private readonly name = h("input", { type: "text", placeholder: "name", "aria-label": "Name of the model; empty: its file's" });
  private readonly place = h("input", { type: "text", value: "1.5, 0, 0", "aria-label": "Place of the model: x, y, z in m, and its turn about z in degrees" });
  private readonly spawned = h("ul", { class: "spawned" });
  private own: Sent[] = []; // the files of a folder of this machine
  private files: string[] = []; // the server's

  constructor(private readonly link: Link, world: World) {
    this.element = section("Models", this.file, h("div", { class: "menu-row" }, this.name, this.place),
      h("div", { class: "menu-row" }, actButton("Your folder…", () => this.pick()), actButton("Add the model", () => this.add())), this.spawned);
    // Others add and remove models, too
    world.description.watch(() => this.element.isConnected && this.file.options.length > 0 && void this.open().catch(reportError));
  }

  // Call it when the menu opens.
  async open(): Promise<void> {
    if (!this.link.mayChangeWorld) return;
    const { files, spawned } = await this.link.request({ case: "listModels", value: {} }, "models");
    this.files = files;
    this.showFiles();
    this.spawned.replaceChildren(...spawned.map((name) => h("li", {}, h("span", { class: "menu-name" }, name), actButton("Remove", () => this.remove(name), `Remove the model ${name}`))));
  }

  private showFiles(): void {
    const before = this.file.value;
    const own = this.own.map(({ path }) => path).filter(isModel);
    const group = (label: string, paths: string[], prefix: string) => (paths.length === 0 ? [] : [h("optgroup", { label }, ...paths.map((path) => h("option", { value: prefix + path }, path)))]);
    this.file.replaceChildren(...group("Yours", own, kOwn), ...group("The server's", this.files, ""));
    if ([...this.file.options].some(({ value }) => value === before)) this.file.value = before;
  }

  private async pick(): Promise<string> {
    const files = (await pickFolder()).filter(({ path }) => isOfModel(path));
    if (!files.some(({ path }) => isModel(path))) throw new Error("This folder holds no model: no .urdf, .sdf, .mjcf, .xml or .yaml file");
    this.own = await Promise.all(files.map(async ({ path, file }) => ({ path, content: new Uint8Array(await file.arrayBuffer()) })));
    this.showFiles();
    this.file.selectedIndex = 0;
    return "";
  }

  private async add(): Promise<string> {
    const chosen = this.file.value;
    if (chosen === "") throw new Error("The server has no models; choose a folder of yours");
    const own = chosen.startsWith(kOwn);
    const value = { file: own ? chosen.slice(kOwn.length) : chosen, name: this.name.value.trim(), pose: poseOf(this.place.value), makeUnique: true, files: own ? this.own : [] };
    const { name, parts } = await this.link.request({ case: "spawnModel", value }, "modelSpawned");
    this.name.value = "";
    await this.open();
    return `'${name}' is here${parts.length > 0 ? `, with ${parts.length === 1 ? "the part" : "the parts"} ${parts.join(", ")}` : ""}`;
  }

  private async remove(name: string): Promise<string> {
    await this.link.request({ case: "removeModel", value: { name } }, "ok");
    await this.open();
    return `'${name}' is gone`;
  }
}
