// How urgent the words of a state are, for their colour. The words come from the port's description, and
// stand beside the colour: nothing is told by colour alone. Pure.

export type Tone = "good" | "busy" | "warn" | "bad" | "plain";

// The first list with a word of the text decides.
const kWords: [Tone, RegExp][] = [
  ["bad", /\b(fault|error|\w*_?err(or)?|lost|frozen|powerfault|\w*_fault|beyond_\w+|fet_temp|emergency stop)\b/i],
  ["warn", /\b(halted|disabled|stopped|not homed|low|curlimit|sw[12r])\b/i],
  ["busy", /\b(moving|homing|motion|inprogress|starting|waiting)\b/i],
  ["good", /\b(ready|ok|home_ok|in range|on)\b/i],
];

export function toneOf(words: string): Tone {
  return kWords.find(([, expression]) => expression.test(words))?.[0] ?? "plain";
}
