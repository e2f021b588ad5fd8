// The graph of a controller's modules.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { ModulePartSchema, ModuleVector, type ModulePart } from "../src/link/messages";
import { graphOf, kAbove, kBelow, labelOf } from "../src/modules/graph";

const { CONTROLLER_INPUT: CI, CONTROLLER_OUTPUT: CO, SENSOR_INPUT: SI, SENSOR_OUTPUT: SO } = ModuleVector;
const end = (part: string, path: string, vector: ModuleVector, first = 0) => ({ part, path, vector, first });

function motion(): ModulePart {
  const names = { controllerInputs: ["Target"], controllerOutputs: ["Angle 1", "Angle 2"], sensorInputs: ["Actual"], sensorOutputs: ["Actual"] };
  const modules = ["", "Arm", "Arm/Ramp", "Arm/Watch"].map((path) => ({ path, isGroup: path === "" || path === "Arm", ...names }));
  const values = { controllerInputs: [1], controllerOutputs: [2, 3], sensorInputs: [4], sensorOutputs: [5] };
  return create(ModulePartSchema, {
    announced: {
      part: "motion", periodNs: 5_000_000n, modules,
      edges: [
        { from: end("motion", "", CI), to: end("motion", "Arm", CI), count: 1 },
        { from: end("motion", "Arm", CI), to: end("motion", "Arm/Ramp", CI), count: 1 },
        { from: end("motion", "Arm/Ramp", CO), to: end("motion", "Arm", CO), count: 2 },
        { from: end("motion", "Arm", SI), to: end("motion", "Arm/Watch", SI), count: 1 },
        { from: end("motion", "Arm/Watch", SO), to: end("motion", "Arm/Ramp", SI), count: 1 },
        { from: end("motion", "", CO), to: end("arm", "", CI), count: 1 },
        { from: end("motion", "", CO, 1), to: end("arm", "", CI, 1), count: 1 },
        { from: end("arm", "", SO), to: end("motion", "", SI), count: 1 },
      ],
    },
    reported: { part: "motion", modules: modules.map((_, i) => ({ ...values, controlNs: 1500n, overridden: i === 3 ? [0] : [] })) },
  });
}

test("parts stand above what they command, with all values of an edge", () => {
  const graph = graphOf([motion()], []);
  assert.deepEqual(graph.nodes.map(({ id, kind, layer }) => [id, kind, layer]), [["motion", "part", 0], ["arm", "hardware", 1]]);
  const down = graph.edges.find((edge) => edge.down)!;
  assert.deepEqual(down.values, [{ name: "Angle 1", value: 2 }, { name: "Angle 2", value: 3 }]);
  assert.equal(labelOf(down, String), "2 and 1 more");
  assert.deepEqual(graph.edges.find((edge) => !edge.down)!.values, [{ name: "Actual", value: 4 }]);
});

test("a group opens to its members between its borders", () => {
  const graph = graphOf([motion()], ["motion", "Arm"]);
  assert.deepEqual(graph.nodes.map(({ id, layer }) => [id, layer]), [[kAbove, 0], ["Arm/Ramp", 1], ["Arm/Watch", 2], [kBelow, 3]]);
  assert.deepEqual(graph.edges.map(({ from, to, down }) => [from, to, down]), [
    [kAbove, "Arm/Ramp", true], ["Arm/Ramp", kBelow, true], [kBelow, "Arm/Watch", false], ["Arm/Watch", "Arm/Ramp", false],
  ]);
  assert.equal(graph.nodes[1]!.controlNs, 1500);
});

test("a held sensor input shows at its module and at the groups around it", () => {
  assert.deepEqual(graphOf([motion()], ["motion", "Arm"]).nodes[2]!.held, ["Actual"]);
  assert.deepEqual(graphOf([motion()], ["motion"]).nodes[1]!.held, ["Actual"]);
  assert.deepEqual(graphOf([motion()], []).nodes[0]!.held, ["Actual"]);
});

test("a circle of edges and a part that is gone end the search", () => {
  const part = motion();
  part.announced!.edges.push(...create(ModulePartSchema, { announced: { edges: [
    { from: end("motion", "Arm/Ramp", CO), to: end("motion", "Arm/Watch", CI), count: 1 },
    { from: end("motion", "Arm/Watch", CO), to: end("motion", "Arm/Ramp", CI), count: 1 },
  ] } }).announced!.edges);
  assert.equal(graphOf([part], ["motion", "Arm"]).nodes.length, 4);
  assert.equal(graphOf([part], ["task"]).nodes.length, 0);
});
