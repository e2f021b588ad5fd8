// Poses that a user has taught: what they are, how they are kept, and what they become as a program. Pure.
import { actualOf } from "../model/desired";

export interface TaughtPose {
  name: string;
  values: Record<string, number>; // by the names of the part's inputs
}

export interface Course {
  part: string;
  poses: TaughtPose[];
}

export class CourseError extends Error {}

// Reads what write() wrote; throws a CourseError that says what is wrong.
export function readCourse(text: string): Course {
  const root = parse(text);
  const { part, poses } = root as Partial<Course>;
  if (typeof part !== "string") throw new CourseError("part: must be a text");
  if (!Array.isArray(poses)) throw new CourseError("poses: must be a list");
  return { part, poses: poses.map((pose, i) => readPose(pose, `poses[${i}]`)) };
}

function parse(text: string): unknown {
  try {
    const root: unknown = JSON.parse(text);
    if (typeof root === "object" && root !== null) return root;
  } catch (error) {
    throw new CourseError(`not JSON: ${(error as Error).message}`);
  }
  throw new CourseError("must be a map");
}

function readPose(entry: unknown, at: string): TaughtPose {
  const { name, values } = (entry ?? {}) as Partial<TaughtPose>;
  if (typeof name !== "string") throw new CourseError(`${at}.name: must be a text`);
  if (typeof values !== "object" || values === null) throw new CourseError(`${at}.values: must be a map`);
  for (const [port, value] of Object.entries(values))
    if (typeof value !== "number" || !Number.isFinite(value)) throw new CourseError(`${at}.values.${port}: must be a number`);
  return { name, values };
}

export function freeName(poses: readonly TaughtPose[]): string {
  for (let i = poses.length + 1; ; ++i) if (!poses.some(({ name }) => name === `Pose ${i}`)) return `Pose ${i}`;
}

// Moves a pose up or down; the list stays as it is at its ends.
export function moved(poses: readonly TaughtPose[], index: number, by: number): TaughtPose[] {
  const to = index + by;
  if (to < 0 || to >= poses.length) return [...poses];
  const list = [...poses];
  const [pose] = list.splice(index, 1);
  list.splice(to, 0, pose!);
  return list;
}

// The port that tells what becomes of an input: "Actual Angle 1" of "Desired Angle 1".
const python = (value: unknown): string => JSON.stringify(value); // texts and numbers are written alike
const yaml = (text: string): string => JSON.stringify(text);

// A controller in Python that goes through the poses once, or for ever.
export function asPython({ part, poses }: Course, loop: boolean): string {
  const list = poses.map(({ name, values }) => `    (${python(name)}, {\n${Object.entries(values).map(([port, value]) => `        ${python(port)}: ${value},\n`).join("")}    }),`).join("\n");
  return `#!/usr/bin/python3
"""Brings the part '${part}' to ${poses.length} poses, one after the other. Made by Visum's page.

    PYTHONPATH=build/release/python python3 THIS_FILE 127.0.0.1:1500
"""

import sys

import visum

PERIOD_MS = 10
LONGEST_S = 60.0  # for one pose
NEAR = {"rad": 0.005, "m": 0.0005}

POSES = [
${list}
]


def go_to(client, arm, name, values):
    for port, value in values.items():
        arm.inputs(port)[0] = value
    arm.write()
    actual = {port: arm.outputs(port.replace("Desired ", "Actual ")) for port in values}
    end_ns = client.time_ns + LONGEST_S * 1e9
    while any(abs(actual[port][0] - value) > NEAR[actual[port].ports[0].unit] for port, value in values.items()):
        if client.time_ns > end_ns:
            raise SystemExit(f"{name}: not reached within {LONGEST_S:g} s")
        client.advance_ms(PERIOD_MS)


def main():
    address = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1:1500"
    with visum.Client(address, name="taught") as client:
        arm = client.part(${python(part)})
        with arm.lease():
            client.join()
            while True:
                for name, values in POSES:
                    go_to(client, arm, name, values)
                if not ${loop ? "True" : "False"}:  # True: over and over again
                    return


if __name__ == "__main__":
    main()
`;
}

// A scenario that writes the poses at fixed times, and checks that each is reached. \`secondsEach\`:
// simulated.
export function asScenario({ part, poses }: Course, scene: string, name: string, secondsEach: number): string {
  const timeline = poses.flatMap(({ name: pose, values }, i) => [
    `  - {at_s: ${i * secondsEach}, say: ${yaml(`to ${pose}`)}}`,
    ...Object.entries(values).map(([port, value]) => `  - {at_s: ${i * secondsEach}, set: {part: ${yaml(part)}, port: ${yaml(port)}, value: ${value}}}`),
  ]);
  const last = poses.at(-1);
  const checks = Object.entries(last?.values ?? {}).map(([port, value]) =>
    `  - name: ${yaml(`${actualOf(port)} at ${last!.name}`)}\n    that: {port: {part: ${yaml(part)}, name: ${yaml(actualOf(port))}}, equals: ${value}, within: 0.005}`);
  return `# Made by Visum's page. Run it by: visum run THIS_FILE
# The scene's path counts from this file; set it to where the scene is.
visum_scenario: 1
name: ${yaml(name)}
scene: ${yaml(scene)}
clock: lockstep
max_sim_s: ${(poses.length + 1) * secondsEach}
until: {at_s: ${poses.length * secondsEach}}

timeline:
${timeline.join("\n")}

checks:
${checks.join("\n")}
`;
}
