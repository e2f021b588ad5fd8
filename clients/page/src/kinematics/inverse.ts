// Inverse kinematics: the joint values that bring a tool to a pose, by damped least squares (Levenberg and
// Marquardt) within the joints' limits. From a start far away it may end in a local minimum; then it starts
// again elsewhere, from places that are always the same. The C++ and Python clients do the same
// (clients/cpp/kinematics.cc). Pure.
import { forward, jacobian, type ChainJoint } from "./chain";
import { length, rotationBetween, subtract, type Pose } from "./pose";

export interface InverseOptions {
  tolerance?: number; // m, and rad: an error below it counts as reached
  iterations?: number; // of each start
  starts?: number; // 1: only from `start`, and so to the nearest solution
}

export interface Solution {
  values: number[]; // the best that was found, within the limits
  reached: boolean;
  positionError: number; // m
  rotationError: number; // rad
}

const kTolerance = 1e-6;
const kIterations = 60;
const kStarts = 400;
const kMetresPerRadian = 0.3; // so much is a radian worth
const kFirstDamping = 1e-3;
const kLeastDamping = 1e-9;
const kMostDamping = 1e6;
const kTurn = Math.PI; // a joint without limits starts within half a turn
const kPrimes = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

export function solve(joints: readonly ChainJoint[], target: Pose, start: readonly number[], options: InverseOptions = {}): Solution {
  const { starts = kStarts } = options;
  let best = descend(joints, target, start.map((value, i) => within(joints[i]!, value)), options);
  for (let n = 1; n < starts && !best.reached; ++n) {
    const found = descend(joints, target, spread(joints, n), options);
    if (found.reached || cost(found) < cost(best)) best = found;
  }
  return best;
}

function descend(joints: readonly ChainJoint[], target: Pose, start: number[], { tolerance = kTolerance, iterations = kIterations }: InverseOptions): Solution {
  let values = start;
  let now = judge(joints, target, values, tolerance);
  let damping = kFirstDamping;
  for (let i = 0; i < iterations && !now.reached; ++i) {
    const step = dampedStep(joints, target, values, damping);
    const next = values.map((value, j) => within(joints[j]!, value + step[j]!));
    const then = judge(joints, target, next, tolerance);
    if (cost(then) < cost(now)) {
      values = next;
      now = then;
      damping = Math.max(kLeastDamping, damping / 5);
    } else {
      damping *= 4;
      if (damping > kMostDamping) break;
    }
  }
  return now;
}

function judge(joints: readonly ChainJoint[], target: Pose, values: number[], tolerance: number): Solution {
  const tool = forward(joints, values);
  const positionError = length(subtract(target.position, tool.position));
  const rotationError = length(rotationBetween(tool.orientation, target.orientation));
  return { values, positionError, rotationError, reached: positionError <= tolerance && rotationError <= tolerance };
}

const cost = ({ positionError, rotationError }: Solution) => positionError ** 2 + (kMetresPerRadian * rotationError) ** 2;

// Solves (JᵀJ + damping) step = Jᵀ error. A joint at a limit that the step would leave does not take part.
function dampedStep(joints: readonly ChainJoint[], target: Pose, values: readonly number[], damping: number): number[] {
  const tool = forward(joints, values);
  const error = [...subtract(target.position, tool.position), ...rotationBetween(tool.orientation, target.orientation).map((part) => kMetresPerRadian * part)];
  const columns = jacobian(joints, values).map(({ linear, angular }) => [...linear, ...angular.map((part) => kMetresPerRadian * part)]);
  const free = joints.map(() => true);
  for (;;) {
    const normal = columns.map((a, i) => columns.map((b, j) => (free[i] && free[j] ? dot(a, b) : 0) + (i === j ? damping : 0)));
    const step = solvePositive(normal, columns.map((column, i) => (free[i] ? dot(column, error) : 0)));
    const stuck = joints.findIndex(({ lower, upper }, i) => free[i] && ((values[i]! <= lower && step[i]! < 0) || (values[i]! >= upper && step[i]! > 0)));
    if (stuck < 0) return step;
    free[stuck] = false; // at most once for each joint
  }
}

const dot = (a: readonly number[], b: readonly number[]) => a.reduce((sum, value, i) => sum + value * b[i]!, 0);

// Cholesky's method for a symmetric positive definite matrix.
export function solvePositive(matrix: readonly (readonly number[])[], right: readonly number[]): number[] {
  const n = right.length;
  const l: number[][] = [];
  const y: number[] = [];
  for (let i = 0; i < n; ++i) {
    const row: number[] = [];
    for (let j = 0; j <= i; ++j) {
      let sum = matrix[i]![j]!;
      for (let k = 0; k < j; ++k) sum -= row[k]! * (j === i ? row[k]! : l[j]![k]!);
      row.push(j === i ? Math.sqrt(Math.max(sum, Number.MIN_VALUE)) : sum / l[j]![j]!);
    }
    l.push(row);
    let sum = right[i]!;
    for (let k = 0; k < i; ++k) sum -= row[k]! * y[k]!;
    y.push(sum / row[i]!);
  }
  const x = new Array<number>(n).fill(0);
  for (let i = n - 1; i >= 0; --i) {
    let sum = y[i]!;
    for (let k = i + 1; k < n; ++k) sum -= l[k]![i]! * x[k]!;
    x[i] = sum / l[i]![i]!;
  }
  return x;
}

const within = ({ lower, upper }: ChainJoint, value: number) => Math.min(upper, Math.max(lower, value));

// The n-th further start: spread evenly over the joints' ranges, each joint by its own irrational step.
function spread(joints: readonly ChainJoint[], n: number): number[] {
  return joints.map(({ lower, upper }, i) => {
    const share = (n * Math.sqrt(kPrimes[i % kPrimes.length]!)) % 1;
    const [from, to] = [Number.isFinite(lower) ? lower : -kTurn, Number.isFinite(upper) ? upper : kTurn];
    return from + share * (to - from);
  });
}
