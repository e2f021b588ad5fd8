// Keeps the layout of each scene in the browser, and shares it by a link.
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import type { PanelPane } from "../panels/pane";
import type { PlotPane } from "../plots/pane";
import { iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Layout } from "../ui/layout";
import { fromHash, share } from "../ui/link_text";
import { report, reportError } from "../ui/toasts";
import type { ViewCamera } from "../view3d/camera";
import { parseLayout, type LayoutData } from "./file";

const kPrefix = "#layout=";
const kStored = "visum.plots."; // which panes are open is kept by Layout, for all scenes

export class LayoutKeeper {
  readonly button = iconButton(icons.link, "Copy a link to this layout", () => void this.share().catch(reportError));
  private restored = "";

  // `camera` is null where the browser draws no 3D.
  constructor(private readonly layout: Layout, private readonly plots: PlotPane, private readonly panel: PanelPane, private readonly camera: ViewCamera | null,
    private readonly world: World, private readonly parts: Parts) {
    plots.changed.on(() => this.keep());
  }

  // Call it when parts and world are known. What the address holds comes first; else what was kept.
  async restore(): Promise<void> {
    const { scene } = this;
    if (this.restored === scene) return;
    const first = this.restored === "";
    this.restored = scene;
    try {
      const shared = first ? await fromHash(kPrefix, location.hash) : null;
      if (shared !== null) return this.use(parseLayout(shared));
      const kept = localStorage.getItem(kStored + scene);
      this.plots.restore(kept ? parseLayout(kept).plots : []);
    } catch (error) {
      reportError(error);
    }
  }

  private get scene(): string {
    return this.world.description.value?.scene ?? "";
  }

  private use({ panes, plots, panel, camera }: LayoutData): void {
    this.layout.use(panes);
    this.plots.restore(plots);
    if (panel) this.panel.open(panel);
    if (camera) this.camera?.look({ name: "", ...camera });
    const missing = plots.flatMap(({ ports }) => ports).filter(({ part, port }) => !this.parts.port(part, port));
    if (missing.length > 0) report(`Not in this world: ${missing.map(({ part, port }) => `${part} ${port}`).join(", ")}`, "error");
  }

  private keep(): void {
    if (this.scene === "" || this.restored !== this.scene) return;
    const data: LayoutData = { visum_layout: 1, panes: this.layout.openPanes, plots: this.plots.data };
    localStorage.setItem(kStored + this.scene, JSON.stringify(data));
  }

  private async share(): Promise<void> {
    const data: LayoutData = { visum_layout: 1, panes: this.layout.openPanes, plots: this.plots.data, panel: this.panel.view.panel };
    if (this.camera) data.camera = this.camera.place;
    const copied = await share(kPrefix, JSON.stringify(data));
    report(`The address now holds this layout${copied ? ", and is on the clipboard" : "; copy it from there"}`);
  }
}
