// Puts the page together.
import "uplot/dist/uPlot.min.css";
import "../styles/base.css";
import "../styles/layout.css";
import "../styles/bar.css";
import "../styles/timeline.css";
import "../styles/tree.css";
import "../styles/view.css";
import "../styles/panel.css";
import "../styles/tool.css";
import "../styles/modules.css";
import "../styles/plots.css";
import "../styles/log.css";
import "../styles/world.css";
import { makeApi } from "./api";
import { connectionBadge, lostBanner, realityBadge } from "./bar/connection";
import { frozenBanner } from "./bar/frozen";
import { firstSteps, showKeys } from "./bar/help";
import { listenForKeys } from "./bar/keys";
import { resetWorld } from "./bar/reset";
import { StopButton } from "./bar/stop";
import { PartStrip } from "./bar/strip";
import { TimeControls } from "./bar/time_controls";
import { timeline } from "./bar/timeline";
import { LayoutKeeper } from "./layout/keeper";
import { Link } from "./link/link";
import type { ResetScope } from "./link/messages";
import { LogPane } from "./log/pane";
import { Clock } from "./model/clock";
import { Events } from "./model/events";
import { takeUpLeases, watchLeaving } from "./model/leaving";
import type { Port } from "./model/part";
import { Parts } from "./model/parts";
import { Recording } from "./model/recording";
import { World } from "./model/world";
import { ModulesView } from "./modules/view";
import { PanelPane } from "./panels/pane";
import { PlotPane } from "./plots/pane";
import { Gizmo } from "./tool/gizmo";
import { Mover } from "./tool/mover";
import { ToolPane } from "./tool/pane";
import { CameraTiles } from "./tree/camera_tiles";
import { profileView } from "./tree/profile";
import { Tree } from "./tree/tree";
import { h, setText } from "./ui/dom";
import { Layout } from "./ui/layout";
import { tabs } from "./ui/tabs";
import { report, reportError, reportTold } from "./ui/toasts";
import { makeSceneView } from "./view3d/scene_view";
import { WorldMenu } from "./world/menu";

const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/session`;
const link = new Link(url, `page ${crypto.getRandomValues(new Uint16Array(1))[0]!.toString(16).padStart(4, "0")}`);
const world = new World(link);
const parts = new Parts(link);
const clock = new Clock(link);
const recording = new Recording(link, parts);
const events = new Events(link);

const layout = new Layout();
document.getElementById("app")!.replaceWith(layout.root);
const view = makeSceneView(layout.view, link, world, parts, clock, recording);
const reset = (scope?: ResetScope) => void resetWorld(link, clock, parts, scope).catch(reportError);
const time = new TimeControls(link, clock, recording, () => reset());
const plots = new PlotPane(layout.panes.plots, parts);
new LogPane(layout.panes.log, events, world, recording);
const panelPlace = h("section", { class: "tab-body" });
const panel = new PanelPane(panelPlace, parts, world);
panel.isEmpty.watch((empty) => layout.offer("panel", !empty));
const keeper = new LayoutKeeper(layout, plots, panel, view?.viewer.view ?? null, world, parts);
layout.toggles.append(keeper.button);
const modules = new ModulesView(link);
const tool = new ToolPane(link, world, parts, new Mover());
layout.panes.panel.append(tabs("Panel or tool", [{ name: "Panel", content: panelPlace }, { name: "Tool", content: tool.element }, { name: "Modules", content: modules.element }]), panelPlace, tool.element, modules.element);
if (view) new Gizmo(view.viewer, world, tool);
const plot = (ports: Port[]) => {
  layout.reveal("plots");
  plots.plot(ports);
};
const tree = new Tree(link, parts, { plot }, profileView(link, clock));
const scene = h("span", { class: "scene" });
const strip = new PartStrip(link, parts);
const stop = new StopButton(link, clock, strip);
layout.bar.append(h("h1", {}, "Visum"), scene, realityBadge(link), time.element, connectionBadge(link, parts, clock), stop.element,
  h("div", { class: "second" }, strip.element, layout.toggles, new WorldMenu(link, world, parts, clock, events, reset).element), timeline(recording, (different) => {
    const port = parts.port(different.part, different.port);
    if (port) plot([port]);
  }));
layout.panes.parts.append(tree.element);
const hint = firstSteps(parts);
if (hint) layout.view.append(hint);
layout.view.append(lostBanner(link), frozenBanner(link, clock, () => reset()), new CameraTiles(parts).element);
window.visum = makeApi(parts, world, recording, view);

// The page is live when it is connected, has drawn data of this world, and knows whether time runs.
let known = false; // the parts of this world
let fresh = false;
function begin(): void {
  known = fresh = false;
  document.documentElement.dataset["visum"] = "loading";
  void readAnew().catch(reportError);
}
link.state.watch((state) => {
  if (state.kind === "open") return begin();
  known = fresh = false;
  document.documentElement.dataset["visum"] = state.kind;
});
world.sampled.on((sample) => {
  fresh = known;
  time.showTime(Number(sample.simTimeNs) / 1e9);
});
if (view) view.viewer.drawn.on(markLive);
else clock.status.watch(markLive);

function markLive(): void {
  if (fresh && link.welcome && clock.status.value) document.documentElement.dataset["visum"] = "live";
}

world.description.watch((description) => {
  setText(scene, description?.scene ?? "");
  document.title = `${description?.scene ?? ""} · Visum`;
});

// After each hello; and after another scene was loaded, which ends leases and subscriptions.
async function readAnew(): Promise<void> {
  await parts.begin();
  await recording.begin(parts.steering);
  await events.begin().catch(reportError); // the world is worth showing without its log
  known = true;
  await world.begin();
  await clock.refresh();
  await keeper.restore();
  view?.viewer.redraw();
  const again = await takeUpLeases(parts);
  if (again.length > 0) report(`This page commands ${again.join(", ")} again`);
}

let stood = false; // whether time stood at the last status
clock.status.watch((status) => {
  if (!status || !link.welcome) return;
  if (status.paused) world.catchUp(status.simTimeNs).catch(reportError);
  recording.playing = !status.paused && !status.frozen;
  const stands = !recording.playing;
  if (stands && !stood) void recording.refresh();
  stood = stands;
  if (status.paused || status.realTimeFactor === 0) return;
  world.adaptTo(status.realTimeFactor).catch(reportError);
  parts.adaptTo(status.realTimeFactor).catch(reportError);
});

// Others reset the world, and load scenes, too.
link.told.on((body) => {
  if (body.case !== "event" || link.recorded.value) return;
  if (body.value.kind === "era") reportTold(body.value.text);
  if (body.value.kind === "load") begin();
});

watchLeaving(parts);
listenForKeys({ toggleRun: () => time.toggleRun(), stop: () => stop.press(), help: showKeys });
link.open();
