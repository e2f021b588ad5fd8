// Puts the page together.
import "uplot/dist/uPlot.min.css";
import "../styles/base.css";
import "../styles/layout.css";
import "../styles/bar.css";
import "../styles/timeline.css";
import "../styles/tree.css";
import "../styles/view.css";
import "../styles/panel.css";
import "../styles/plots.css";
import { makeApi } from "./api";
import { connectionBadge, lostBanner, realityBadge } from "./bar/connection";
import { TimeControls } from "./bar/time_controls";
import { timeline } from "./bar/timeline";
import { Link } from "./link/link";
import { Clock } from "./model/clock";
import { Parts } from "./model/parts";
import { Recording } from "./model/recording";
import { World } from "./model/world";
import { PanelPane } from "./panels/pane";
import { PlotPane } from "./plots/pane";
import { profileView } from "./tree/profile";
import { Tree } from "./tree/tree";
import { h, setText } from "./ui/dom";
import { Layout } from "./ui/layout";
import { reportError } from "./ui/toasts";
import { Ghost } from "./view3d/ghost";
import { Overlays } from "./view3d/overlays";
import { Selection } from "./view3d/selection";
import { SensorOverlay } from "./view3d/sensors";
import { viewToolbar } from "./view3d/toolbar";
import { Viewer } from "./view3d/viewer";

const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/session`;
const link = new Link(url, `page ${crypto.getRandomValues(new Uint16Array(1))[0]!.toString(16).padStart(4, "0")}`);
const world = new World(link);
const parts = new Parts(link);
const clock = new Clock(link);
const recording = new Recording(link, parts);

const layout = new Layout();
document.getElementById("app")!.replaceWith(layout.root);
const viewer = new Viewer(layout.view, world);
const time = new TimeControls(link, clock, recording);
const plots = new PlotPane(layout.panes.plots, parts);
new PanelPane(layout.panes.panel, parts, world);
const tree = new Tree(link, parts, {
  plot(ports) {
    layout.reveal("plots");
    plots.plot(ports);
  },
}, profileView(link, clock));
const scene = h("span", { class: "scene" });
layout.bar.append(h("h1", {}, "Visum"), scene, realityBadge(link), time.element, layout.toggles, connectionBadge(link, parts), timeline(recording));
layout.panes.parts.append(tree.element);
const ghost = new Ghost(viewer, world, parts);
const overlays = new Overlays(viewer, world, new SensorOverlay(viewer, world, parts), ghost, layout.view);
const selection = new Selection(viewer, world, parts, link, clock, layout.view);
const notShown = h("p", { class: "not-shown", hidden: true });
layout.view.append(viewToolbar(viewer, world, overlays, selection, layout.view), notShown, ghost.sign, lostBanner(link));
world.description.watch((description) => {
  const losses = description?.losses ?? [];
  notShown.hidden = losses.length === 0;
  notShown.title = losses.join("\n");
  setText(notShown, `Not shown or simulated: ${losses.length === 1 ? losses[0] : `${losses.length} things of the models`}`);
});
window.visum = makeApi(parts, world, viewer, ghost);

// The page is live when it is connected, has drawn data of this connection, and knows whether time runs.
let fresh = false;
link.state.watch((state) => {
  fresh = false;
  document.documentElement.dataset["visum"] = state.kind === "open" ? "loading" : state.kind;
  if (state.kind === "open") void begin().catch(reportError);
});
world.sampled.on((sample) => {
  fresh = true;
  time.showTime(Number(sample.simTimeNs) / 1e9);
});
viewer.drawn.on(() => {
  if (fresh && link.welcome && clock.status.value) document.documentElement.dataset["visum"] = "live";
});

async function begin(): Promise<void> {
  setText(scene, link.welcome?.scene ?? "");
  document.title = `${link.welcome?.scene ?? ""} · Visum`;
  await parts.begin();
  await recording.begin(parts.steering);
  await world.begin();
  await clock.refresh();
  viewer.redraw();
}

let stood = false; // whether time stood at the last status
clock.status.watch((status) => {
  if (!status || !link.welcome) return;
  if (status.paused) world.catchUp(status.simTimeNs).catch(reportError);
  recording.playing = !status.paused && !status.frozen;
  const stands = !recording.playing;
  if (stands && !stood) void recording.refresh().then(() => recording.refill());
  stood = stands;
  if (status.paused || status.realTimeFactor === 0) return;
  world.adaptTo(status.realTimeFactor).catch(reportError);
  parts.adaptTo(status.realTimeFactor).catch(reportError);
});

const dark = matchMedia("(prefers-color-scheme: dark)");
const paint = () => viewer.setBackground(getComputedStyle(document.documentElement).getPropertyValue("--sky").trim());
dark.addEventListener("change", paint);
paint();

document.addEventListener("keydown", (event) => {
  const target = event.target as HTMLElement;
  const typing = target.closest("input, select, textarea, button, summary, [contenteditable]");
  if (event.key === " " && !typing) {
    event.preventDefault();
    if (!event.repeat) time.toggleRun();
  }
});

link.open();
