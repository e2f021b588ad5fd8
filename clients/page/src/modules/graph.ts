// The modules of controllers as a graph: what stands in an opened group, and the edges between. Pure.
import { ModuleVector, type ModuleDescription, type ModuleEnd, type ModulePart, type ModuleState } from "../link/messages";

export interface GraphNode {
  id: string;
  name: string;
  kind: "part" | "group" | "module" | "hardware" | "border";
  opens: string[] | null; // the path that it opens
  controlNs: number;
  senseNs: number;
  periodNs: number;
  held: string[]; // sensor inputs that hold a value for a test
  layer: number; // from 0, the uppermost
}

// All that goes from one node to another in one direction.
export interface GraphEdge {
  from: string;
  to: string;
  down: boolean;
  values: { name: string; value: number }[];
}

export interface Graph {
  nodes: GraphNode[];
  edges: GraphEdge[];
}

export const kAbove = "(above)";
export const kBelow = "(below)";

interface Place {
  part: ModulePart;
  module: ModuleDescription;
  state: ModuleState | undefined;
}

// `parts`: all that are announced, with what was announced. `path`: of the opened group; empty: all parts;
// then the part, then groups.
export function graphOf(parts: readonly ModulePart[], path: readonly string[]): Graph {
  const graph = path.length === 0 ? ofParts(parts) : ofGroup(parts, path);
  giveLayers(graph);
  return graph;
}

function find(parts: readonly ModulePart[], part: string, path: string): Place | null {
  const found = parts.find(({ announced }) => announced?.part === part);
  const index = found?.announced?.modules.findIndex((module) => module.path === path) ?? -1;
  if (!found || index < 0) return null;
  return { part: found, module: found.announced!.modules[index]!, state: found.reported?.modules[index] };
}

function namesOf(module: ModuleDescription, vector: ModuleVector): readonly string[] {
  switch (vector) {
    case ModuleVector.CONTROLLER_INPUT: return module.controllerInputs;
    case ModuleVector.CONTROLLER_OUTPUT: return module.controllerOutputs;
    case ModuleVector.SENSOR_INPUT: return module.sensorInputs;
    default: return module.sensorOutputs;
  }
}

function valuesOf(state: ModuleState | undefined, vector: ModuleVector): readonly number[] {
  switch (vector) {
    case ModuleVector.CONTROLLER_INPUT: return state?.controllerInputs ?? [];
    case ModuleVector.CONTROLLER_OUTPUT: return state?.controllerOutputs ?? [];
    case ModuleVector.SENSOR_INPUT: return state?.sensorInputs ?? [];
    default: return state?.sensorOutputs ?? [];
  }
}

// The values that pass along an edge: of whichever end is known.
function passing(parts: readonly ModulePart[], from: ModuleEnd, to: ModuleEnd, count: number): GraphEdge["values"] {
  for (const end of [from, to]) {
    const place = find(parts, end.part, end.path);
    if (!place) continue;
    const names = namesOf(place.module, end.vector);
    const values = valuesOf(place.state, end.vector);
    return Array.from({ length: count }, (_, i) => ({ name: names[end.first + i] ?? "?", value: values[end.first + i] ?? NaN }));
  }
  return [];
}

const goesDown = (end: ModuleEnd) => end.vector === ModuleVector.CONTROLLER_INPUT || end.vector === ModuleVector.CONTROLLER_OUTPUT;

function addEdge(graph: Graph, from: string, to: string, down: boolean, values: GraphEdge["values"]): void {
  const known = graph.edges.find((edge) => edge.from === from && edge.to === to && edge.down === down);
  if (known) known.values.push(...values);
  else graph.edges.push({ from, to, down, values });
}

function node(place: Place, id: string, name: string, kind: GraphNode["kind"], opens: string[] | null): GraphNode {
  const { module, state, part } = place;
  return {
    id, name, kind, opens, layer: 0,
    controlNs: Number(state?.controlNs ?? 0n), senseNs: Number(state?.senseNs ?? 0n), periodNs: Number(part.announced?.periodNs ?? 0n),
    held: (state?.overridden ?? []).map((index) => module.sensorInputs[index] ?? "?"),
  };
}

// Holds of modules inside are shown at the groups around them, too.
function heldBelow(part: ModulePart, path: string): string[] {
  return (part.announced?.modules ?? []).flatMap((module, i) => {
    if (path !== "" && module.path !== path && !module.path.startsWith(`${path}/`)) return [];
    return (part.reported?.modules[i]?.overridden ?? []).map((index) => module.sensorInputs[index] ?? "?");
  });
}

function ofParts(parts: readonly ModulePart[]): Graph {
  const graph: Graph = { nodes: [], edges: [] };
  for (const part of parts) {
    const name = part.announced?.part ?? "";
    const place = find(parts, name, "");
    if (place) graph.nodes.push({ ...node(place, name, name, "part", [name]), held: heldBelow(part, "") });
  }
  for (const { announced } of parts) {
    for (const { from, to, count } of announced?.edges ?? []) {
      if (!from || !to || from.part === to.part) continue;
      for (const { part } of [from, to]) {
        if (!graph.nodes.some(({ id }) => id === part))
          graph.nodes.push({ id: part, name: part, kind: "hardware", opens: null, controlNs: 0, senseNs: 0, periodNs: 0, held: [], layer: 0 });
      }
      addEdge(graph, from.part, to.part, goesDown(from), passing(parts, from, to, count));
    }
  }
  return graph;
}

function ofGroup(parts: readonly ModulePart[], path: readonly string[]): Graph {
  const graph: Graph = { nodes: [], edges: [] };
  const [partName = "", ...groups] = path;
  const own = groups.join("/");
  const part = parts.find(({ announced }) => announced?.part === partName);
  if (!part) return graph;
  const border = (id: string, name: string): GraphNode => ({ id, name, kind: "border", opens: null, controlNs: 0, senseNs: 0, periodNs: 0, held: [], layer: 0 });
  graph.nodes.push(border(kAbove, "above"));
  for (const module of part.announced?.modules ?? []) {
    if (!isChild(module.path, own)) continue;
    const name = module.path.slice(module.path.lastIndexOf("/") + 1);
    const place = find(parts, partName, module.path)!;
    const made = node(place, module.path, name, module.isGroup ? "group" : "module", module.isGroup ? [...path, name] : null);
    graph.nodes.push({ ...made, held: module.isGroup ? heldBelow(part, module.path) : made.held });
  }
  graph.nodes.push(border(kBelow, "below"));
  const idOf = (end: ModuleEnd, isStart: boolean): string | null => {
    if (end.part !== partName) return null;
    if (end.path === own) return goesDown(end) === isStart ? kAbove : kBelow;
    return isChild(end.path, own) ? end.path : null;
  };
  for (const { from, to, count } of part.announced?.edges ?? []) {
    if (!from || !to) continue;
    const start = idOf(from, true);
    const end = idOf(to, false);
    if (start !== null && end !== null) addEdge(graph, start, end, goesDown(from), passing(parts, from, to, count));
  }
  return graph;
}

function isChild(path: string, group: string): boolean {
  if (path === "" || path === group) return false;
  const rest = group === "" ? path : path.startsWith(`${group}/`) ? path.slice(group.length + 1) : "";
  return rest !== "" && !rest.includes("/");
}

// Each node stands below those that command it, and above those that it senses. A circle of edges ends the
// search after as many rounds as there are nodes.
function giveLayers(graph: Graph): void {
  const byId = new Map(graph.nodes.map((one) => [one.id, one]));
  const above = byId.get(kAbove);
  for (const one of graph.nodes) one.layer = above && one !== above ? 1 : 0;
  for (let round = 0; round < graph.nodes.length; ++round) {
    for (const { from, to, down } of graph.edges) {
      const upper = byId.get(down ? from : to)!;
      const lower = byId.get(down ? to : from)!;
      if (upper !== lower) lower.layer = Math.min(graph.nodes.length, Math.max(lower.layer, upper.layer + 1));
    }
  }
  const below = byId.get(kBelow);
  if (below) below.layer = Math.max(1, ...graph.nodes.filter((one) => one !== below).map(({ layer }) => layer + 1));
}

// "0.6000", "0.6000 and 6 more"
export function labelOf(edge: GraphEdge, format: (value: number) => string): string {
  const first = edge.values[0];
  if (!first) return "";
  const more = edge.values.length - 1;
  return more > 0 ? `${format(first.value)} and ${more} more` : format(first.value);
}
