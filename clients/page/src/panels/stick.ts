// A virtual stick: two ports under one finger, or under the arrow keys. With a spring it returns to its
// middle.
import { h } from "../ui/dom";
import { share } from "../ui/numbers";
import { commandedOf, valueOf, writeAll, type Context, type Widget } from "./widget";

const kKeyStep = 0.1;
const kArrows: Record<string, [number, number] | undefined> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };

export function stick({ data, ports: bound }: Context): Widget {
  const ports = bound.slice(0, 2);
  const knob = h("span", { class: "knob" });
  const area = h("div", { class: "w-stick", tabIndex: 0, role: "application", "aria-label": `${data.label}: stick, arrow keys move it` }, knob);
  let enabled = true;
  let deflected = false; // a hand still holds it
  const range = (i: number) => {
    const { minimum = -1, maximum = 1 } = ports[i]?.description ?? {};
    return { minimum: data.minimum ?? minimum, maximum: data.maximum ?? maximum };
  };
  const middle = (i: number) => (range(i).minimum + range(i).maximum) / 2;
  const write = (shares: [number, number]) => {
    if (!enabled) return;
    deflected = true;
    shares.forEach((part, i) => {
      const { minimum, maximum } = range(i);
      if (ports[i]) writeAll([ports[i]], minimum + Math.min(1, Math.max(0, part)) * (maximum - minimum));
    });
  };
  const shares = (of: typeof valueOf): [number, number] => [0, 1].map((i) => share(of(ports[i]), range(i).minimum, range(i).maximum)) as [number, number];
  const follow = (event: PointerEvent) => {
    const { left, top, width, height } = area.getBoundingClientRect();
    write([(event.clientX - left) / width, 1 - (event.clientY - top) / height]);
  };
  const letGo = () => {
    if (data.spring && deflected && enabled) ports.forEach((port, i) => writeAll([port], middle(i)));
    deflected = false;
  };
  area.addEventListener("pointerdown", (event) => (area.setPointerCapture(event.pointerId), follow(event)));
  area.addEventListener("pointermove", (event) => area.hasPointerCapture(event.pointerId) && follow(event));
  for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) area.addEventListener(end, letGo);
  area.addEventListener("keydown", (event) => {
    const step = kArrows[event.key];
    if (!step) return;
    event.preventDefault();
    const now = shares(commandedOf);
    write([now[0] + kKeyStep * step[0], now[1] + kKeyStep * step[1]]);
  });
  area.addEventListener("keyup", (event) => kArrows[event.key] && letGo());
  return {
    body: area,
    update() {
      const [x, y] = shares(valueOf);
      knob.style.left = `${(100 * x).toFixed(2)}%`;
      knob.style.top = `${(100 * (1 - y)).toFixed(2)}%`;
    },
    setEnabled(on) {
      enabled = on;
      area.setAttribute("aria-disabled", String(!on));
    },
    dispose: letGo,
  };
}
